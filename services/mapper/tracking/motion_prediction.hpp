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

inline constexpr double kMaxStride = 0.5;  ///< s between scans; beyond it a constant velocity is a guess

/// The vehicle's motion over the last scan, from scans.
struct RecentMotion {
  std::int64_t end = 0;  ///< us, of the last scan
  scan::Twist twist;     ///< over the last scan
  double stride = 0.05;  ///< s from scan to scan
};

/// The motion that is predicted for a scan before it is registered.
struct MotionPrediction {
  bool with_odometry = false;  ///< odometry covers the time from the last scan's end to this one's
  bool blind = false;          ///< it does not, and that time is too long for a constant velocity
  bool implausible = false;    ///< it does, but claims an impossible motion and was not used
  bool stationary = false;
  scan::SweepMotion sweep;
  Pose T_last_base = Pose::Identity();  ///< base_link at this scan's end to base_link at the last's
  registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< of T_last_base
  /// Covariance of de-skew: odometry's, for the motion from the middle of the scan to its end.
  registration::Matrix6 deskew_covariance = registration::Matrix6::Zero();
};

/// Predicts the motion by odometry if it covers the time since the last scan, else as predict_constant_velocity().
[[nodiscard]] MotionPrediction predict_motion(const config::TrackerConfig& config, const RecentMotion& recent,
                                              const scan::Scan& scan, const scan::OdometryHistory& odometry);
/// Predicts the motion after seconds of messages were missed: from odometry's pose at the last scan's end to its pose
/// now. Nothing if odometry does not cover the scan, or claims an impossible motion because its filter began anew.
[[nodiscard]] std::optional<MotionPrediction> predict_across_gap(const config::TrackerConfig& config,
                                                                 const RecentMotion& recent, const Pose& T_odom_last,
                                                                 const scan::Scan& scan,
                                                                 const scan::OdometryHistory& odometry);
/// Predicts a constant velocity since the last scan. If that ended more than 2.5 s ago, the motion of one scan only.
[[nodiscard]] MotionPrediction predict_constant_velocity(const RecentMotion& recent, const scan::Scan& scan);

/// Takes `twist` as one of several hypotheses to begin registration from. The covariance is that of one hypothesis,
/// which is far smaller than that of all of them together.
[[nodiscard]] MotionPrediction predict_from_hypothesis(const scan::Twist& twist, std::int64_t from,
                                                       const scan::Scan& scan);
/// Hypotheses of the motion when nothing is known, the most likely first: straight ahead at all speeds up to
/// `max_speed`, m/s, and at most 5 m per scan, and slowly backwards. They are spaced so that registration converges
/// from one of them. `stride`: s between scans.
[[nodiscard]] std::vector<scan::Twist> initial_motion_hypotheses(double max_speed, double stride);
/// Hypotheses around the expected motion: turned to either side, faster and slower.
[[nodiscard]] std::vector<scan::Twist> nearby_motion_hypotheses(const scan::Twist& prediction, double stride);

}  // namespace curbstone::mapper::tracking
