#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/marking_lines/line_types.hpp"
#include "services/semantic_map/marking_lines/marking_field.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"
#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::marking_lines {

/// Links cells of paint to typed lines: chains along the vote's tangents (chain_markings()), measured pieces, without
/// the bars of crossings, joined across gaps, with a smoothing spline through each line. Isolated pieces shorter than
/// 0.8 m are left out. `path`: as driven, m in map. `is_seen`: see type_sequence(). Ids count from 0. The same cells in
/// the same order give the same lines.
[[nodiscard]] std::vector<tile::MarkingLine> link_marking_cells(const std::vector<MapMarkingCell>& cells,
                                                                const tile::DrivenPath& path,
                                                                const markings::MarkingParameters& parameters,
                                                                const SeenGround& is_seen = nullptr);

/// Matches lines to earlier ones nearby and reuses their ids; new lines get new ids.
class MarkingLineIds {
 public:
  void assign(std::vector<tile::MarkingLine>& lines);

 private:
  std::vector<tile::MarkingLine> before_;
  std::int32_t next_ = 0;
};

}  // namespace curbstone::semantic_map::marking_lines
