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
  bool weak = false;                               ///< lower than a curb by itself: a dropped kerb on a line
  double reach = 0;                                ///< m along the curb, on each side, that the evidence is from
  bool operator==(const CurbPoint&) const = default;
};

/// Section VI, outlier filter: of parallel detections the best one stays (non-maximum suppression across the step),
/// detections must lie on a line with others, and low ones count only where such a line goes on over them. Their
/// face's middle and how it leans along the line say where the foot is. Of the centre tile, at most one point a cell.
[[nodiscard]] std::vector<CurbPoint> filter_curbs(const tile::Around<std::vector<CurbCandidate>>& candidates,
                                                  const tile::CurbParameters& parameters);

}  // namespace curbstone::semantic_map::curbs
