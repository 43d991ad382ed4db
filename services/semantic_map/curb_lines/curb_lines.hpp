#pragma once

#include <vector>

#include "services/semantic_map/curb_lines/curb_linker.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// Links curb points to polylines along the foot of the curb: chains (chain_curbs()), a smoothing spline through each,
/// vertices each 0.2 m. The spline's normal gives the high side, which is on the right (the tangent is the high side
/// turned by +90 degrees). The spline uses all points of a curb so far. Where a kerb is lowered for 1 m or more the
/// line is cut, and that piece is `dropped`. Confidence: the points', times the share of the line that is not bridged.
/// Ids count from 0 in the order of the points: the same points in the same order give the same lines.
[[nodiscard]] std::vector<tile::CurbLine> link_curbs(const std::vector<MapCurbPoint>& points);

/// Matches lines to earlier ones nearby and reuses their ids; new lines get new ids.
class CurbLineIds {
 public:
  void assign(std::vector<tile::CurbLine>& lines);

 private:
  std::vector<tile::CurbLine> before_;
  std::int32_t next_ = 0;
};

}  // namespace curbstone::semantic_map::curb_lines
