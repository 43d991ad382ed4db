#include "services/mapper/tracking/odometry_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::tracking {
namespace {

constexpr double kMaxDifference = 0.06;             // m by which the two distances may differ,
constexpr double kMaxRelativeDifference = 0.15;     // plus this share of the longer one,
constexpr double kMinSigmas = 4;                    // and at least this number of sigmas for a fault
constexpr double kMinAgreementRatio = 1.03;         // factor in agreement by which the scans must fit better
constexpr double kMinDistanceWithDirection = 0.03;  // m, shortest motion that has a direction
constexpr double kMinDistanceToClear =
    0.12;  // m, shortest motion that can end a fault: near standstill both always agree
constexpr double kMinHeadingOffset = 0.35;  // rad, from which directions differ
constexpr double kMinSpeed = 0.5;           // m/s, speed below which the LiDAR is not believed
constexpr double kMaxSpeedChange = 0.3;     // share of its speed by which a vehicle may change meanwhile
constexpr double kMaxDirectionSpread = 0.5;

double signed_angle(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

}  // namespace

void OdometryCheck::add(const Pair& pair) {
  const double difference = (pair.by_scans - pair.by_odometry).norm();
  const double distance = std::max(pair.by_scans.norm(), pair.by_odometry.norm());
  const bool differ = difference > kMaxDifference + kMaxRelativeDifference * distance;
  if (differ &&
      (difference < kMinSigmas * pair.sigma || pair.agreement < kMinAgreementRatio * pair.agreement_with_odometry))
    return;
  if (!differ) {
    if (state_ != State::kGood && distance < kMinDistanceToClear) return;
    if (distance >= kMinDistanceToClear) is_new_ = false;
    differing_.clear();
    agreed_velocity_ = pair.by_scans / pair.seconds;
    if (++num_agreeing_ >= kMinPairs) state_ = State::kGood;
    return;
  }
  num_agreeing_ = 0;
  last_ = pair;
  differing_.push_back(pair);
  if (differing_.size() > kMinPairs) differing_.pop_front();
  if (differing_.size() == kMinPairs) decide();
}

/// Decides between a wrong yaw of the LiDAR, which shows the same direction in all pairs, and wrong odometry.
void OdometryCheck::decide() {
  const State before = state_;
  double sum = 0;
  const double first = signed_angle(differing_.front().by_odometry, differing_.front().by_scans);
  state_ = State::kDirection;
  for (const Pair& pair : differing_) {
    const bool has_direction = std::min(pair.by_odometry.norm(), pair.by_scans.norm()) > kMinDistanceWithDirection;
    const double from_first =
        std::remainder(signed_angle(pair.by_odometry, pair.by_scans) - first, 2 * std::numbers::pi);
    if (!has_direction || std::abs(from_first) > kMaxDirectionSpread) state_ = State::kDistance;
    sum += from_first;
  }
  heading_offset_ = std::remainder(first + sum / static_cast<double>(differing_.size()), 2 * std::numbers::pi);
  if (std::abs(heading_offset_) < kMinHeadingOffset) state_ = State::kDistance;
  if (state_ == before) return;
  const double change = (last_.by_scans / last_.seconds - agreed_velocity_).norm();
  is_continuous_ = agreed_velocity_.norm() > kMinSpeed && change < kMaxSpeedChange * agreed_velocity_.norm();
  counters_.add(state_ == State::kDistance ? "faults.odometry.way" : "faults.lidar.aside");
}

std::optional<double> OdometryCheck::heading_offset() const {
  return state_ == State::kDirection ? std::optional(heading_offset_) : std::nullopt;
}

void OdometryCheck::add_faults(std::vector<std::string>& faults, double yaw) const {
  if (disagrees())
    faults.push_back(fmt::format("ODOMETRY: it goes {:.1f} m/s where the LiDAR sees the vehicle go {:.1f} m/s: {}",
                                 last_.by_odometry.norm() / last_.seconds, last_.by_scans.norm() / last_.seconds,
                                 is_continuous_
                                     ? "do the wheels slip, or is an encoder dead? The map goes by the LiDAR alone"
                                     : "do the wheels slip, is an encoder dead, or does something large drive along "
                                       "beside it? The map may be wrong"));
  if (state_ == State::kDirection)
    faults.push_back(
        fmt::format("LiDAR: it sees the vehicle drive {:.0f} deg to the {} of where odometry does: the map is wrong. "
                    "Is it mounted so? "
                    "Then the yaw in vehicle.lidar is {:.2f}, and not {:.2f}; or do the wheels count backwards?",
                    std::abs(heading_offset_) * 180 / std::numbers::pi, heading_offset_ > 0 ? "left" : "right",
                    std::remainder(yaw - heading_offset_, 2 * std::numbers::pi), yaw));
}

}  // namespace curbstone::mapper::tracking
