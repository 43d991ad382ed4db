#include "services/localizer/tracking/tracker.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

constexpr double kBlindSpeed = 1.0;  // m/s, 1 sigma, by which a vehicle may differ from its steady motion
constexpr double kBlindTurn = 0.3;   // rad/s
constexpr double kBlindFor = 0.5;    // s: after that, where it is must be confirmed again
constexpr double kMostSigma = 2.0;   // m: of a lost vehicle; a search from farther off finds another wall
constexpr double kMostYaw = 0.2;     // rad
constexpr int kFirstLooks = 3;       // at a place where it begins: all that they say is new
constexpr double kNewsStanding = 0.05;
constexpr double kNewYaw = 0.02;    // rad, by which the points come to lie in other cells
constexpr int kPlacesWhenLost = 5;  // looked at in a revolution,
constexpr int kRevolutions = 4;     // or one place in so many

}  // namespace

void Tracker::predict(const Motion& motion) {
  const Eigen::Matrix3d R = belief_.T_map_base.linear();
  Matrix6 F = Matrix6::Identity();
  F.topRightCorner<3, 3>() = -R * skew(motion.T_last_base.translation());
  F.bottomRightCorner<3, 3>() = motion.T_last_base.linear().transpose();
  belief_.covariance = F * belief_.covariance * F.transpose();
  belief_.T_map_base = normalised(belief_.T_map_base * motion.T_last_base);

  double position = config_.odometry_floor_m + config_.odometry_m * motion.T_last_base.translation().norm();
  double rotation = config_.odometry_floor_rad + config_.odometry_rad * angle_of(motion.T_last_base);
  if (!motion.with_odometry) {
    position += kBlindSpeed * std::min(motion.seconds, 10.0);
    rotation += kBlindTurn * std::min(motion.seconds, 10.0);
  }
  belief_.covariance.diagonal().head<3>().array() += position * position;
  belief_.covariance.diagonal().tail<3>().array() += rotation * rotation;
  // A bound on what a lost vehicle may look like; and no more than this is a Gaussian good for.
  const double widest = std::sqrt(belief_.covariance.diagonal().head<3>().maxCoeff()) / kMostSigma;
  const double most_turned = std::sqrt(belief_.covariance.diagonal().tail<3>().maxCoeff()) / kMostYaw;
  const double excess = std::max(widest, most_turned);
  if (excess > 1) belief_.covariance /= excess * excess;
}

void Tracker::judge(const PoseFit& fit) {
  const bool fits = fit.matched_share() >= config_.min_match;
  // On another town's map a street or two match by half.
  const bool finds =
      fit.matched_share() >= (lost_ ? std::max(config_.find_match, config_.min_match) : config_.min_match);
  fitting_ = finds ? fitting_ + 1 : 0;
  failing_ = fits ? 0 : failing_ + 1;
  const Eigen::Matrix2d plane = belief_.covariance.topLeftCorner<2, 2>();
  const double sigma = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(plane).eigenvalues()(1));
  if (failing_ >= kInARow || !(sigma < config_.max_sigma)) {
    lost_ = true;
    if (!(sigma < config_.max_sigma)) fitting_ = 0;
  } else if (lost_ && surroundings_.all_seen() && fitting_ >= (was_found_ ? kInARowAgain : kInARow)) {
    lost_ = false;
    was_found_ = true;
  }
}

double Tracker::news_of(const Motion& motion) const {
  if (looks_ < kFirstLooks) return 1;
  const double cells = motion.T_last_base.translation().norm() / kCellSize;
  return std::min(1.0, kNewsStanding + cells + angle_of(motion.T_last_base) / kNewYaw);
}

PoseFit Tracker::track(const std::vector<Eigen::Vector3d>& points, const Motion& motion, fields::SavedMap& map) {
  predict(motion);
  if (!motion.with_odometry && motion.seconds > kBlindFor) {
    lost_ = true;
    fitting_ = 0;
  }
  const PoseBelief predicted = belief_;
  PoseFit fit = fit_pose(points, predicted, map, config_, news_of(motion));
  const bool usable = is_finite(fit.belief.T_map_base) && fit.belief.covariance.allFinite();
  // What does not fit tells nothing: the pose goes on with odometry, and is known worse and worse.
  const bool is_used = usable && fit.matched_share() >= config_.min_match;
  if (is_used) belief_ = fit.belief;
  looks_ = is_used ? looks_ + 1 : 0;
  fit.belief = belief_;
  judge(fit);
  look_around(points, fit, map);
  return fit;
}

void Tracker::look_around(const std::vector<Eigen::Vector3d>& points, PoseFit& fit, fields::SavedMap& map) {
  revolution_ = (revolution_ + 1) % kRevolutions;
  const int places = lost_ ? kPlacesWhenLost : revolution_ == 0 ? 1 : 0;
  const auto better = surroundings_.better_than(fit, points, places, map, config_);
  if (!better) return;
  fit = *better;
  belief_ = fit.belief;
  lost_ = true;
  fitting_ = 0;
  surroundings_.restart();
  looks_ = 0;
}

Matrix6 Tracker::published_covariance() const {
  Matrix6 covariance = belief_.covariance;
  covariance.diagonal().head<3>().array() += config_.map_sigma * config_.map_sigma;
  covariance.diagonal().tail<3>().array() += config_.map_yaw_sigma * config_.map_yaw_sigma;
  return covariance;
}

}  // namespace curbstone::localizer::tracking
