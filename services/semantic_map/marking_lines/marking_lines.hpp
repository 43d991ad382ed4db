#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/marking_lines/marking_field.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"
#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::marking_lines {

/// Cells of paint to lines with a type: chained along the vote's tangents (chain_markings()), measured, bars of
/// crossings taken out, the rest joined across gaps, a smoothing spline through each. Pieces shorter than 0.8 m that
/// nothing goes on are left out. `path`: driven, m in map. Ids count from 0. The same cells in the same order give the
/// same lines.
[[nodiscard]] std::vector<tile::MarkingLine> link_marking_cells(const std::vector<MapMarkingCell>& cells,
                                                                const tile::DrivenPath& path,
                                                                const markings::MarkingParameters& parameters);

/// Gives lines the ids that the lines near them had before, and new ones new ids.
class MarkingLineIds {
 public:
  void assign(std::vector<tile::MarkingLine>& lines);

 private:
  std::vector<tile::MarkingLine> before_;
  std::int32_t next_ = 0;
};

}  // namespace curbstone::semantic_map::marking_lines
