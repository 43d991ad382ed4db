#pragma once

#include <cstdint>
#include <vector>

#include "services/mapper/deskew.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/odometry_history.hpp"
#include "services/mapper/registration.hpp"
#include "services/mapper/revolution.hpp"

namespace curbstone {

inline constexpr double kLongestStride = 0.5;  ///< s from end to end: after that, a constant velocity is a mere guess

/// How the vehicle moved until now, as revolutions told.
struct RecentMotion {
  std::int64_t end = 0;  ///< us, of the last revolution
  Twist twist;           ///< over it
  double stride = 0.05;  ///< s from revolution to revolution
};

/// What is known of the motion of a revolution before the LiDAR is looked at.
struct MotionExpectation {
  bool with_odometry = false;  ///< odometry spans from the last revolution's end to this one's
  bool blind = false;          ///< nothing does, and it is too long for a constant velocity
  bool incredible = false;     ///< odometry does, but says what no vehicle can do: it was not taken
  bool stationary = false;
  SweepMotion sweep;
  Pose T_last_base = Pose::Identity();   ///< base_link now, seen from base_link at the last revolution's end
  Matrix6 covariance = Matrix6::Zero();  ///< of T_last_base
  /// Odometry's share in it, of the middle of the revolution seen from its end: what de-skew may be off by.
  Matrix6 deskew_covariance = Matrix6::Zero();
};

/// By odometry where it spans, else as expect_steady().
[[nodiscard]] MotionExpectation expect_motion(const MapperConfig& config, const RecentMotion& recent,
                                              const Revolution& revolution, const OdometryHistory& odometry);
/// The vehicle goes on as it did; where that was seconds ago, as for a revolution's time only.
[[nodiscard]] MotionExpectation expect_steady(const RecentMotion& recent, const Revolution& revolution);

/// The vehicle may move so: one of several guesses to begin from, each far better known than all of them together.
[[nodiscard]] MotionExpectation expect_perhaps(const Twist& twist, std::int64_t from, const Revolution& revolution);
/// How the vehicle may move when nothing is known: straight on at all speeds up to `max_speed`, m/s (and 5 m a
/// revolution), and slowly back, so close that registration finds the way from one of them; the likeliest first.
/// `stride` s between revolutions.
[[nodiscard]] std::vector<Twist> first_motions(double max_speed, double stride);
/// Others than the one that was expected: faster, slower, and turned.
[[nodiscard]] std::vector<Twist> other_motions(const Twist& expected, double stride);

/// us to s.
[[nodiscard]] inline double seconds(std::int64_t from, std::int64_t to) {
  return static_cast<double>(to - from) * 1e-6;
}

}  // namespace curbstone
