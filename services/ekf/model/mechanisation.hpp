#pragma once

#include <optional>

#include "services/ekf/base/samples.hpp"
#include "services/ekf/model/motion_window.hpp"
#include "services/ekf/model/process_model.hpp"

namespace curbstone::ekf::model {

/// One IMU sample in body axes.
struct TimedInertial {
  std::int64_t utime = 0;  ///< us
  Inertial imu;
};

/// Propagates a belief in time: with the IMU where there are samples on both sides, else with the wheels. Records the
/// motion since the last correction, for comparison with the wheels.
class Mechanisation {
 public:
  /// rad/s, 1 sigma, and rad/s/sqrt(Hz): the yaw rate of a vehicle whose turn is not measured.
  static constexpr double kUsualTurn = 0.3;

  Mechanisation(const base::EkfConfig& config, const Geometry& geometry) : config_(config), geometry_(geometry) {}

  /// Propagates to `utime`. `next` is the IMU sample at or after it; null if there is none yet.
  void advance(Belief& belief, std::int64_t utime, const TimedInertial* next, bool standing);
  /// Sets the IMU sample at the belief's time, from which the next step starts.
  void set_last_imu(const TimedInertial& sample) { last_imu_ = sample; }
  /// rad/s, yaw rate to use while there is no IMU; nothing: the wheels do not show it.
  void set_wheel_yaw_rate(std::optional<double> rate) { wheel_yaw_rate_ = rate; }
  /// Sets the process noise from now on.
  void set_noise(const base::NoiseConfig& noise) { config_.noise = noise; }
  void reset();

  /// Whether the latest IMU sample is recent enough, at `utime`, to continue from.
  [[nodiscard]] bool imu_at_hand(std::int64_t utime) const {
    return last_imu_ && base::seconds_between(last_imu_->utime, utime) <= config_.timing.max_imu_gap;
  }
  [[nodiscard]] const std::optional<TimedInertial>& last_imu() const { return last_imu_; }
  [[nodiscard]] double wheel_yaw_rate() const { return wheel_yaw_rate_.value_or(0.0); }
  [[nodiscard]] MotionWindow& window() { return window_; }

 private:
  void step(Belief& belief, const Inertial& imu, double dt, bool standing);
  void coast(Belief& belief, double dt);

  base::EkfConfig config_;
  Geometry geometry_;
  std::optional<TimedInertial> last_imu_;
  MotionWindow window_;
  double inertial_speed_ = 0.0;                 // m/s, see SlipDetector::Comparison
  std::optional<double> wheel_yaw_rate_ = 0.0;  // rad/s
};

}  // namespace curbstone::ekf::model
