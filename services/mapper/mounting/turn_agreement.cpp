#include "services/mapper/mounting/turn_agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::mounting {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

}  // namespace

void TurnAgreement::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  if (!pairs_.empty() && utime - pairs_.newest() > scan::PosePairs::kSpan) interrupt();
  utime_ = utime;
  pairs_.add(utime, T_map_base, T_odom_base);
  const Eigen::Vector3d apart = pairs_.turned_apart(T_map_base, T_odom_base);
  note(turn_, std::abs(apart.z()), scan::PosePairs::kMaxTurnDifference, "faults.apart.turn");
  note(tilt_, apart.head<2>().norm(), kTilt, "faults.apart.tilt");
}

void TurnAgreement::note(Disagreement& apart, double by, double limit, const char* counter) {
  if (by < limit) return;
  if (!is_reported(apart)) {
    apart.max = 0;
    counters_.add(counter);
  }
  apart.max = std::max(apart.max, by);
  apart.since = utime_;
}

void TurnAgreement::add_faults(std::vector<std::string>& faults) const {
  const auto seconds_ago = [&](const Disagreement& apart) { return static_cast<double>(utime_ - apart.since) * 1e-6; };
  if (is_reported(tilt_))
    faults.push_back(
        fmt::format("LiDAR: it has tilted by {:.1f} deg against odometry within a second, {:.0f} s ago: has its mount "
                    "slipped, or is the IMU's gyro or accelerometer wrong? The map may lean from there on",
                    kDegrees * tilt_.max, seconds_ago(tilt_)));
  if (is_reported(turn_))
    faults.push_back(fmt::format(
        "LiDAR and odometry differ by {:.1f} deg in how it turned within a second, {:.0f} s ago: did "
        "something large drive along beside it, has the LiDAR slipped, or is the gyro wrong? The map may be "
        "bent from there on",
        kDegrees * turn_.max, seconds_ago(turn_)));
}

}  // namespace curbstone::mapper::mounting
