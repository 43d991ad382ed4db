#include "services/localizer/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"

namespace curbstone::localizer::tracking {
namespace {

constexpr double kBlindFor = 0.5;     // s without odometry: after that the pose must be confirmed again
constexpr int kFirstCorrections = 3;  // revolutions at a new place that count as independent
constexpr double kNewStanding = 0.05;
constexpr double kNewYaw = 0.02;    // rad of turning, after which points lie in other cells
constexpr int kPlacesWhenLost = 5;  // tried in a revolution,
constexpr int kRevolutions = 4;     // or one place in this many revolutions

}  // namespace

void Tracker::judge(const PoseFit& fit) {
  const bool fits = fit.held_share() >= config_.min_match;
  // On the map of another town one or two streets match by half.
  const bool finds = lost_ ? fit.matched_share() >= std::max(config_.find_match, config_.min_match) : fits;
  fitting_ = finds ? fitting_ + 1 : 0;
  failing_ = fits ? 0 : failing_ + 1;
  const Eigen::Matrix2d plane = belief_.covariance.topLeftCorner<2, 2>();
  const double sigma = std::sqrt(eigen_pairs<2>(plane).values(1));
  if (failing_ >= kConfirmations || !(sigma < config_.max_sigma)) {
    lost_ = true;
    if (!(sigma < config_.max_sigma)) fitting_ = 0;
  } else if (lost_ && alternatives_.all_tried() && fitting_ >= (was_found_ ? kReconfirmations : kConfirmations)) {
    lost_ = false;
    was_found_ = true;
  }
}

double Tracker::independent_share(const Motion& motion) const {
  if (corrections_ < kFirstCorrections) return 1;
  const double cells = motion.T_last_base.translation().norm() / kCellSize;
  return std::min(1.0, kNewStanding + cells + angle_of(motion.T_last_base) / kNewYaw);
}

PoseFit Tracker::track(const ThinnedScan& scan, const Motion& motion, fields::SavedMap& map) {
  const Motion corrected = scale_.corrected(motion);
  const PoseBelief prior = scale_.predict(belief_, corrected, predicted(belief_, corrected, config_));
  belief_ = prior;
  if (!motion.with_odometry && motion.seconds > kBlindFor) {
    lost_ = true;
    fitting_ = 0;
  }
  PoseFit fit = fit_pose(scan, prior, map, config_, independent_share(motion));
  const bool usable = is_finite(fit.belief.T_map_base) && fit.belief.covariance.allFinite();
  // A revolution that does not fit gives no information: the pose continues with odometry, and its covariance grows.
  // Where the vehicle is lost for want of walls, the ground still holds it across the street.
  const bool is_elsewhere = lost_ && (!was_found_ || failing_ > 0);
  const bool is_used = usable && (is_elsewhere ? fit.matched_share() : fit.held_share()) >= config_.min_match;
  if (is_used) {
    scale_.update(prior, fit.belief);
    belief_ = fit.belief;
    information_ = fit.information;
  }
  corrections_ = is_used ? corrections_ + 1 : 0;
  fit.belief = belief_;
  judge(fit);
  const std::optional<PoseFit> better = better_nearby(fit, scan, map);
  if (!better) return fit;
  continue_from(*better);
  return *better;
}

std::optional<PoseFit> Tracker::better_nearby(const PoseFit& own, const ThinnedScan& scan, fields::SavedMap& map) {
  revolution_ = (revolution_ + 1) % kRevolutions;
  const int places = lost_ ? kPlacesWhenLost : revolution_ == 0 ? 1 : 0;
  return alternatives_.better_than(own, scan, places, map, config_);
}

void Tracker::continue_from(const PoseFit& elsewhere) {
  belief_ = elsewhere.belief;
  lost_ = true;
  fitting_ = 0;
  alternatives_.restart();
  scale_.forget_pose();
  corrections_ = 0;
}

/// Includes the distortion of the map. The structures that constrain the pose here also constrained the vehicle that
/// made the map. Where they are few, the map drifted as that vehicle's odometry did. With half the information a map
/// has twice the error variance at each place, and needs twice the distance to be corrected: hence the square. Further
/// measurements do not reduce this error, because all of them share it.
Matrix6 Tracker::published_covariance() const {
  Vector6 drift;
  drift << Eigen::Vector3d::Constant(config_.map_drift_m), Eigen::Vector3d::Constant(config_.map_drift_rad);
  const Matrix6 held =
      Matrix6::Identity() + config_.map_independent * drift.asDiagonal() * information_ * drift.asDiagonal();
  const Matrix6 left = inverse(held);  // 1: no constraint, the whole drift remains
  return belief_.covariance + drift.asDiagonal() * left * left * drift.asDiagonal();
}

}  // namespace curbstone::localizer::tracking
