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
  Eigen::Vector2d up = Eigen::Vector2d::Zero();  ///< the candidate's, copied because every pair reads it
  const CurbCandidate* candidate = nullptr;
};

/// m each way along a line within which candidates support each other: several scan lines of 16 beams.
inline constexpr double kLineReach = 2.0;

/// How far the face leans back, m for each m up, pooled over all faces on an arc with this one (CandidateField),
/// because one place has few points. `others`: at least all within kLineReach, including the candidate itself.
[[nodiscard]] double lean_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others);

/// Candidates, and the support that they give each other.
class CandidateField {
 public:
  explicit CandidateField(std::vector<PlacedCandidate> candidates);
  /// In the order of x; those of equal x in the order in which they were given.
  [[nodiscard]] const std::vector<PlacedCandidate>& by_x() const { return by_x_; }
  /// Section VI, evidence along a line: the pooled certainty of all steps that lie on an arc with this one (root of the
  /// sum of squares, in units of the noise). As in the stick vote, the arc passes through both places and follows the
  /// candidate's direction. A step counts less the farther it is along the arc, beside the tangent, or turned against
  /// the arc. Where scan lines are far apart, steps can be fitted between them in wrong directions, but such steps do
  /// not follow each other along their own directions. The candidate must belong to the field.
  [[nodiscard]] double pool_along_line(const PlacedCandidate& candidate) const;

 private:
  std::vector<PlacedCandidate> by_x_;
  std::vector<double> x_, y_, up_x_, up_y_;  // of by_x_, by columns
};

/// The part of `by_x`, which is sorted by x, that may lie within `reach` of a place.
template <class T>
std::span<const T> near_x(const std::vector<T>& by_x, double x, double reach) {
  const auto before = [](const T& a, double at) { return a.at.x() < at; };
  const auto begin = std::lower_bound(by_x.begin(), by_x.end(), x - reach, before);
  return {begin, std::lower_bound(begin, by_x.end(), std::nextafter(x + reach, 1e9), before)};
}

}  // namespace curbstone::semantic_map::curbs
