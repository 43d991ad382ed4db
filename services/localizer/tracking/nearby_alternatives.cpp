#include "services/localizer/tracking/nearby_alternatives.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

constexpr double kSpacing = 0.7;   // m
constexpr int kAlong = 4;          // places ahead, and as many behind
constexpr int kAcross = 2;         // to the left, and to the right
constexpr double kClearly = 0.05;  // share of points
constexpr int kRows = 2 * kAcross + 1;
constexpr int kPlaces = (2 * kAlong + 1) * kRows;

/// The position of place `i` relative to the vehicle, m in base_link.
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

/// Compares two places by how much each explains of what either sees, ground and upright alike: shares of 0..1. A place
/// gains nothing if points that do not fit there are left out of its counts. Points that do not constrain the pose are
/// not compared either.
struct Scores {
  double own, other;
};
Scores scores(const PoseFit& own, const PoseFit& other, const TrackingConfig& config) {
  const double uprights = std::max({own.uprights, other.uprights, 1});
  const double grounds = std::max({own.grounds, other.grounds, 1});
  const auto score = [&](const PoseFit& fit) {
    const double upright = config.use_walls ? 0.5 * fit.uprights_matched / uprights : 0;
    const double ground = config.heights != Heights::kNone ? 0.5 * fit.grounds_matched / grounds : 0;
    return upright + ground;
  };
  return {score(own), score(other)};
}

/// Whether the place is displaced from the pose along an axis in which its fit is degenerate, so that only odometry
/// determines it there: along such an axis the explained share varies by chance.
bool lies_along_degenerate_axis(const PoseFit& own, const PoseFit& other) {
  const Pose& there = other.belief.T_map_base;
  const Eigen::Vector3d off = there.linear().transpose() * (there.translation() - own.belief.T_map_base.translation());
  for (int axis = 0; axis < 2; ++axis) {
    if ((other.degenerate & (1 << axis)) != 0 && std::abs(off[axis]) > kSpacing / 2) return true;
  }
  return false;
}

}  // namespace

std::optional<PoseFit> NearbyAlternatives::better_than(const PoseFit& own, const ThinnedScan& scan, int count,
                                                       fields::SavedMap& map, const TrackingConfig& config) {
  std::optional<PoseFit> best;
  for (int i = 0; i < count; ++i, next_ = (next_ + 1) % kPlaces) {
    seen_ = std::min(seen_ + 1, kPlaces);
    const PoseFit other = fit_pose(scan, prior_at(own.belief.T_map_base, next_), map, config);
    if (other.matched_share() == 0) continue;  // too little is seen there to decide
    const Scores against_own = scores(own, other, config);
    if (against_own.other <= against_own.own + kClearly || lies_along_degenerate_axis(own, other)) continue;
    if (best) {
      const Scores against_best = scores(*best, other, config);
      if (against_best.other <= against_best.own) continue;
    }
    best = other;
  }
  return best;
}

bool NearbyAlternatives::all_tried() const {
  return seen_ == kPlaces;
}

}  // namespace curbstone::localizer::tracking
