#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/mapper/config/tracker_config.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::tracking {

inline constexpr double kLongestStride = 0.5;  ///< s from end to end: after that, a constant velocity is a mere guess

/// How the vehicle moved until now, by its scans.
struct RecentMotion {
  std::int64_t end = 0;  ///< us, of the last scan
  scan::Twist twist;     ///< over it
  double stride = 0.05;  ///< s from scan to scan
};

/// What is known of the motion of a scan before the LiDAR is looked at.
struct MotionExpectation {
  bool with_odometry = false;  ///< odometry spans from the last scan's end to this one's
  bool blind = false;          ///< nothing does, and it is too long for a constant velocity
  bool incredible = false;     ///< odometry does, but says what no vehicle can do: it was not taken
  bool stationary = false;
  scan::SweepMotion sweep;
  Pose T_last_base = Pose::Identity();  ///< base_link now, seen from base_link at the last scan's end
  registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< of T_last_base
  /// Odometry's share in it, of the middle of the scan seen from its end: what de-skew may be off by.
  registration::Matrix6 deskew_covariance = registration::Matrix6::Zero();
};

/// By odometry where it spans, else as expect_steady().
[[nodiscard]] MotionExpectation expect_motion(const config::TrackerConfig& config, const RecentMotion& recent,
                                              const scan::Scan& scan, const scan::OdometryHistory& odometry);
/// Where seconds of messages were missed: from what odometry said at the last scan's end to what it says now. Nothing
/// where it does not cover the scan, or says what no vehicle can do: its filter began anew.
[[nodiscard]] std::optional<MotionExpectation> expect_across(const config::TrackerConfig& config,
                                                             const RecentMotion& recent, const Pose& T_odom_last,
                                                             const scan::Scan& scan,
                                                             const scan::OdometryHistory& odometry);
/// The vehicle goes on as it did; where that was seconds ago, as for a scan's time only.
[[nodiscard]] MotionExpectation expect_steady(const RecentMotion& recent, const scan::Scan& scan);

/// The vehicle may move so: one of several guesses to begin from, each far better known than all of them together.
[[nodiscard]] MotionExpectation expect_perhaps(const scan::Twist& twist, std::int64_t from, const scan::Scan& scan);
/// How the vehicle may move when nothing is known: straight on at all speeds up to `max_speed`, m/s (and 5 m a
/// scan), and slowly back, so close that registration finds the way from one of them; the likeliest first.
/// `stride` s between scans.
[[nodiscard]] std::vector<scan::Twist> first_motions(double max_speed, double stride);
/// Others than the one that was expected: faster, slower, and turned.
[[nodiscard]] std::vector<scan::Twist> other_motions(const scan::Twist& expected, double stride);

}  // namespace curbstone::mapper::tracking
