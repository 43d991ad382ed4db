#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

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

/// How far the face leans back, m for each m up, by all faces on an arc with this one: a place has few points on its
/// own. The arc is that of CandidateField. `others`: at least all within kLineReach, itself too.
[[nodiscard]] double lean_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others);

/// Candidates that are asked about each other.
class CandidateField {
 public:
  explicit CandidateField(std::vector<PlacedCandidate> candidates);
  /// In the order of x; those of equal x in the order in which they were given.
  [[nodiscard]] const std::vector<PlacedCandidate>& by_x() const { return by_x_; }
  /// Section VI, evidence along a line: the certainty of all steps that lie on an arc with this one, pooled (root of
  /// the sum of squares, in units of the noise). As in the stick vote, the arc is that through both places along the
  /// candidate's direction; what is far along, beside the tangent or turned against the arc counts less. Where scan
  /// lines are far apart, steps can be put between them in directions that are not the curb's; but such steps do not
  /// follow each other along their own directions. The candidate is one of the field.
  [[nodiscard]] double pool_along_line(const PlacedCandidate& candidate) const;

 private:
  std::vector<PlacedCandidate> by_x_;
  std::vector<double> x_, y_, up_x_, up_y_;  // theirs, by columns
};

/// Of those in the order of x, the ones that may be within `reach` of a place.
template <class T>
std::span<const T> near_x(const std::vector<T>& by_x, double x, double reach) {
  const auto before = [](const T& a, double at) { return a.at.x() < at; };
  const auto begin = std::lower_bound(by_x.begin(), by_x.end(), x - reach, before);
  return {begin, std::lower_bound(begin, by_x.end(), std::nextafter(x + reach, 1e9), before)};
}

}  // namespace curbstone::semantic_map::curbs
