#include "services/mapper/travel/lever_arm.hpp"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "common/statistics/consistent_median.hpp"

namespace curbstone::mapper::travel {
namespace {

constexpr double kPlaceStep = 0.2;                // m, and
constexpr double kTurnStep = 0.05;                // rad, between places
constexpr std::int64_t kMaxDuration = 8'000'000;  // us, of a bend: odometry drifts at rest
constexpr double kArmSpread = 0.12;               // m: largest half-width of the middle half of the bends

Eigen::Rotation2Dd turn_by(double angle) {
  return Eigen::Rotation2Dd(angle);
}

double yaw_between(const Pose& a, const Pose& b) {
  const Eigen::Matrix3d R = a.linear().transpose() * b.linear();
  return std::atan2(R(1, 0), R(0, 0));
}

}  // namespace

LeverArm::Bend LeverArm::between(const Place& from, const Place& to) {
  const Pose by_map = from.T_map_base.inverse() * to.T_map_base;
  const Pose by_odometry = from.T_odom_base.inverse() * to.T_odom_base;
  Bend bend;
  bend.turn = yaw_between(from.T_odom_base, to.T_odom_base);
  bend.by_map = by_map.translation().head<2>();
  bend.by_odometry = by_odometry.translation().head<2>();
  const Eigen::Vector2d ahead = turn_by(bend.turn / 2) * Eigen::Vector2d::UnitX();
  bend.speed = ahead.dot(bend.by_odometry) / (1e-6 * static_cast<double>(to.utime - from.utime));
  return bend;
}

void LeverArm::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  const Place place{utime, T_map_base, T_odom_base};
  if (!places_.empty() && utime <= places_.back().utime) interrupt();
  if (!places_.empty()) {
    const Pose& last = places_.back().T_odom_base;
    if ((T_odom_base.translation() - last.translation()).norm() < kPlaceStep &&
        std::abs(yaw_between(last, T_odom_base)) < kTurnStep)
      return;
  }
  places_.push_back(place);
  const auto is_bend = [&](const Place& from) { return std::abs(yaw_between(from.T_odom_base, T_odom_base)) >= kTurn; };
  while ((T_odom_base.translation() - places_.front().T_odom_base.translation()).norm() > kMaxWay ||
         utime - places_.front().utime > kMaxDuration)
    places_.pop_front();
  if (!is_bend(places_.front())) return;
  while (is_bend(places_[1])) places_.pop_front();
  const Bend bend = between(places_.front(), place);
  places_.assign(1, place);
  if (std::abs(bend.speed) > kMaxSpeed) return;
  bends_.push_back(bend);
  if (bends_.size() > kMaxBends) bends_.pop_front();
}

std::optional<LeverArm::Excess> LeverArm::excess(const TravelDirection::Straight& straight) const {
  std::vector<double> x, y;
  for (const Bend& bend : bends_) {
    const Eigen::Vector2d moved = turn_by(straight.heading_offset) * bend.by_odometry / (1 + straight.length_error);
    const Eigen::Matrix2d A = Eigen::Matrix2d::Identity() - turn_by(bend.turn).toRotationMatrix();
    const Eigen::Vector2d d = A.inverse() * (bend.by_map - moved);
    x.push_back(d.x());
    y.push_back(d.y());
  }
  const auto along = consistent_median(std::move(x), kArmSpread, kMinBends);
  const auto across = consistent_median(std::move(y), kArmSpread, kMinBends);
  if (!along || !across) return std::nullopt;
  return Excess{{*along, *across}, bends_.size()};
}

}  // namespace curbstone::mapper::travel
