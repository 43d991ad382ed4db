#pragma once

#include <vector>

#include "services/semantic_map/curbs/curb_evidence.hpp"

namespace curbstone::semantic_map::curbs {

/// A point on a curb.
struct CurbPoint {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();  ///< m from the tile's corner
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();   ///< unit, towards the higher side
  double z = 0;                                    ///< m in map, of the low side at the foot
  double height = 0;                               ///< m, of the step
  double confidence = 0;                           ///< 0..1
  bool weak = false;                               ///< lower than a curb must be to count on its own: a dropped kerb
  double reach = 0;                                ///< m along the curb, on each side, from which the evidence comes
  bool operator==(const CurbPoint&) const = default;
};

/// Section VI, outlier filter, for the centre tile. Of parallel detections the best one is kept (non-maximum
/// suppression across the step). Detections must lie on a line with others; low ones count only where such a line
/// continues over them. The foot is computed from the middle of the face and its lean along the line. At most one point
/// per cell.
[[nodiscard]] std::vector<CurbPoint> filter_curbs(const tile::Around<std::vector<CurbCandidate>>& candidates,
                                                  const tile::CurbParameters& parameters);

}  // namespace curbstone::semantic_map::curbs
