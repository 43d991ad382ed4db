#pragma once

#include <Eigen/Core>
#include <span>

#include "services/semantic_map/curbs/curb_evidence.hpp"

namespace curbstone::semantic_map::curbs {

/// A candidate with its place in the frame of the centre tile.
struct PlacedCandidate {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< m
  Eigen::Vector2d up = Eigen::Vector2d::Zero();  ///< the candidate's: all pairs are asked for it
  const CurbCandidate* candidate = nullptr;
};

/// m each way along a line that candidates bear each other out: several scan lines of 16 beams.
inline constexpr double kLineReach = 2.0;

/// Section VI, evidence along a line: the certainty of all steps that lie on an arc with this one, pooled (root of the
/// sum of squares, in units of the noise). As in the stick vote, the arc is that through both places along the
/// candidate's direction; what is far along, beside the tangent or turned against the arc counts less. Where scan lines
/// are far apart, steps can be put between them in directions that are not the curb's; but such steps do not follow
/// each other along their own directions. `others`: at least all within kLineReach, itself too.
[[nodiscard]] double pool_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others);

/// How far the face leans back, m for each m up, by all faces on an arc with this one: a place has few points on its
/// own. `others` as above.
[[nodiscard]] double lean_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others);

}  // namespace curbstone::semantic_map::curbs
