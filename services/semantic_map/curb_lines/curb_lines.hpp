#pragma once

#include <vector>

#include "services/semantic_map/curb_lines/curb_linker.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// Curb points to polylines along the foot of the curb: linked (chain_curbs()), a smoothing spline through each chain,
/// vertices each 0.2 m with the spline's normal as the high side, which is on the right (so the tangent is the high
/// side turned by +90 degrees). All that was seen of a curb so far goes into its spline. Where a kerb is lowered for 1
/// m or more the line is cut: that piece is `dropped`. Confidence: the points', times the share of the line that is not
/// bridged. Ids count from 0 in the order of the points: the same points in the same order give the same lines.
[[nodiscard]] std::vector<tile::CurbLine> link_curbs(const std::vector<MapCurbPoint>& points);

/// Gives lines the ids that the lines near them had before, and new ones new ids.
class CurbLineIds {
 public:
  void assign(std::vector<tile::CurbLine>& lines);

 private:
  std::vector<tile::CurbLine> before_;
  std::int32_t next_ = 0;
};

}  // namespace curbstone::semantic_map::curb_lines
