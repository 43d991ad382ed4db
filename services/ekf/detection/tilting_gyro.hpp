#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::detection {

/// Detects a leap of the gyro's bias about a level axis: for half a second or more the gyro shows an even roll or pitch
/// that adds up to kMinAngle, and gravity, which is what the accelerometer shows less the wheels' acceleration, does
/// not turn with it. A slope is seen by both. Wheels that slip falsify gravity for a moment, but the gyro shows no turn
/// then; so it must last for kLasts intervals. A noisy IMU must show more, by what its noise adds up to. Takes
/// consecutive intervals of the wheels. A value type; one thread.
class TiltingGyro {
 public:
  static constexpr double kMinAngle = 0.06;  ///< rad
  static constexpr int kLasts = 6;           ///< intervals

  /// Means of an interval of the wheels.
  struct Interval {
    double seconds = 0.0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, of the IMU by wheels and gyro, body axes
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();      ///< rad/s, the gyro's, body axes
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     ///< m/s^2, the accelerometer's, body axes
  };
  struct Leap {
    Eigen::Vector2d rate = Eigen::Vector2d::Zero();  ///< rad/s about x and y, in excess
    double seconds = 0.0;                            ///< s for which it has been seen, at least
    double way = 0.0;                                ///< m, driven meanwhile
    /// What the filter would believe without it: the state from before, moved on by gyro and wheels; roll and pitch by
    /// gravity.
    model::NavState state;
  };
  /// `state`: the filter's; `noise`: the IMU's.
  std::optional<Leap> add(const Interval& interval, const model::NavState& state, const base::NoiseConfig& noise);
  /// Call it where intervals are missing.
  void interrupt() {
    seen_.clear();
    suspected_ = {};
  }

 private:
  struct Seen {
    Interval interval;
    Eigen::Vector3d up;     // by gravity, body axes
    model::NavState state;  // at its end
  };
  static constexpr std::array<std::size_t, 4> kWindows = {10, 20, 40, 80};  // intervals, of 50 ms or more
  struct Excess {
    Eigen::Vector2d rate;      // rad/s
    Eigen::Vector3d bias, up;  // the gyro's, with the leap, rad/s; of odom, body axes
  };
  struct Suspicion {
    Eigen::Vector2d rate = Eigen::Vector2d::Zero();
    int lasts = 0;  // intervals
  };
  struct GyroTurn {
    Eigen::Vector3d up;  // at the end, as the gyro has turned it
    double seconds = 0.0;
    std::array<Eigen::Vector2d, 2> halves = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};  // rad
    std::array<double, 2> half_seconds = {};
  };
  [[nodiscard]] Eigen::Vector3d mean_up(std::size_t begin, const model::NavState& state) const;
  [[nodiscard]] GyroTurn turn_by_gyro(std::size_t begin, std::size_t intervals, const Eigen::Vector3d& bias,
                                      const Eigen::Vector3d& up) const;
  [[nodiscard]] std::optional<Excess> excess_within(std::size_t intervals, const base::NoiseConfig& noise) const;
  [[nodiscard]] Leap leap_since(std::size_t begin, const Excess& excess) const;

  std::deque<Seen> seen_;  // newest last
  std::array<Suspicion, kWindows.size()> suspected_;
};

}  // namespace curbstone::ekf::detection
