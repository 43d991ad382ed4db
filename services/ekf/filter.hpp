#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "common/counters.hpp"
#include "services/ekf/estimate.hpp"
#include "services/ekf/motion_window.hpp"
#include "services/ekf/pose_history.hpp"
#include "services/ekf/slip_detector.hpp"
#include "services/ekf/start_up.hpp"
#include "services/ekf/still_detector.hpp"
#include "services/ekf/wheel_odometer.hpp"

namespace curbstone {

/// Error-state Kalman filter of wheels and IMU. The equations are in process_model.hpp and measurement_model.hpp, the
/// state in error_state.hpp; here is what is done when:
///
/// - start-up (StartUp); then every IMU sample predicts from the sample before, by the difference of the stamps, with
///   wheel samples between the two served at their own times;
/// - every interval of the wheels corrects: driving, by both wheels' speeds and the non-holonomic constraint; standing,
///   by zero velocity and zero rate. A wheel that slips is left out;
/// - without IMU it coasts on the wheels, without wheels on the IMU and the constraint; both heal by themselves.
///
/// Takes samples in the order of their stamps (Sequencer). A stamp that goes back, or a step of more than
/// timing.max_jump, restarts the clock: the pose stays where it is, speed and tilt are doubted.
///
/// A value type without clock or threads: a copy is a check point from which it can go on.
class Filter {
 public:
  explicit Filter(const EkfConfig& config);

  /// Appends to `out` one estimate at the sample's stamp, once started.
  void add(const ImuSample& sample, std::vector<Estimate>& out);
  /// Appends estimates only while there is no IMU: at the wheels' stamps.
  void add(const WheelSample& sample, std::vector<Estimate>& out);

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] const Belief& belief() const { return belief_; }
  /// T_odom_base at any time of the last seconds.
  [[nodiscard]] std::optional<Pose> pose_at(std::int64_t utime) const { return history_.at(utime); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct TimedInertial {
    std::int64_t utime = 0;
    Inertial imu;  // body axes
  };
  using WheelStep = WheelOdometer::Step;

  void start(const ImuSample& sample);
  void restart_clock(std::int64_t utime);
  void restore_if_not_finite();

  // prediction
  void serve_pending(const TimedInertial* next);
  void advance(std::int64_t utime, const TimedInertial* next);
  void step(const Inertial& imu, double dt);
  void coast(double dt);
  void update_standing(const ImuSample& sample);
  void leave_standing();

  // correction
  void correct_with_wheels(WheelStep step, bool coasting);
  void correct_driving(const WheelInterval& interval);
  void correct_coasting(const WheelInterval& interval);
  void correct_standing();
  template <int Rows>
  void apply(const Observation<Rows>& z) {
    correct(belief_, z, continuous_gain(belief_, z));
  }
  void correct_without_wheels();
  [[nodiscard]] Observation<2> observe_constraint(const BodyMotion& motion);
  [[nodiscard]] double wheel_sigma(const WheelInterval& interval, std::size_t wheel) const;
  void notice_slip(const WheelInterval& interval, const std::array<double, 2>& distances);
  void notice_refusal(std::optional<std::int64_t>& since, bool refused, double residual);

  void emit(const Inertial& imu, double dt, bool no_imu, std::vector<Estimate>& out);
  [[nodiscard]] bool wheels_missing(std::int64_t utime) const;

  EkfConfig config_;
  Geometry geometry_;
  StartUp start_up_;
  StillDetector still_;
  WheelOdometer odometer_;
  SlipDetector slip_;
  PoseHistory history_;
  Counters counters_;

  bool started_ = false;
  Belief belief_;
  Belief last_good_;  // the last one that was finite
  std::optional<TimedInertial> last_imu_;
  std::deque<WheelSample> pending_;          // wait for the IMU sample after them
  std::optional<std::int64_t> last_wheels_;  // us
  MotionWindow window_;
  bool standing_ = false;
  double inertial_speed_ = 0.0;                                          // m/s, see SlipDetector::Comparison
  double coasting_yaw_rate_ = 0.0;                                       // rad/s, from the wheels
  std::array<std::int64_t, 2> slipping_until_ = {INT64_MIN, INT64_MIN};  // us
  std::optional<std::int64_t> wheels_refused_since_;                     // us
  std::optional<std::int64_t> constraint_refused_since_;                 // us
};

}  // namespace curbstone
