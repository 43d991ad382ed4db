#include "services/localizer/tracking/surroundings.hpp"

#include <algorithm>

namespace curbstone::localizer::tracking {
namespace {

constexpr double kSpacing = 0.7;   // m
constexpr int kAlong = 4;          // places ahead, and as many behind
constexpr int kAcross = 2;         // to the left, and to the right
constexpr double kClearly = 0.05;  // share of points
constexpr int kRows = 2 * kAcross + 1;
constexpr int kPlaces = (2 * kAlong + 1) * kRows;

/// Where place `i` lies from the vehicle, m in base_link.
Eigen::Vector3d place(int i) {
  return {kSpacing * (i / kRows - kAlong), kSpacing * (i % kRows - kAcross), 0};
}

PoseBelief prior_at(const Pose& pose, int i) {
  Vector6 sigma;
  sigma << 0.25, 0.25, 0.1, 0.02, 0.02, 0.03;
  PoseBelief prior{pose, sigma.cwiseAbs2().asDiagonal()};
  prior.T_map_base.translation() += pose.linear() * place(i);
  return prior;
}

/// Of all that was seen, ground and upright alike: 0..1.
double score(const PoseFit& fit) {
  if (fit.matched_share() == 0) return 0;
  return 0.5 * fit.uprights_matched / fit.uprights + 0.5 * fit.grounds_matched / fit.grounds;
}

}  // namespace

std::optional<PoseFit> Surroundings::better_than(const PoseFit& own, const std::vector<Eigen::Vector3d>& points,
                                                 int count, fields::SavedMap& map, const TrackingConfig& config) {
  std::optional<PoseFit> best;
  for (int i = 0; i < count; ++i, next_ = (next_ + 1) % kPlaces) {
    seen_ = std::min(seen_ + 1, kPlaces);
    const PoseFit other = fit_pose(points, prior_at(own.belief.T_map_base, next_), map, config);
    if (score(other) > std::max(score(own) + kClearly, best ? score(*best) : 0)) best = other;
  }
  return best;
}

bool Surroundings::all_seen() const {
  return seen_ == kPlaces;
}

}  // namespace curbstone::localizer::tracking
