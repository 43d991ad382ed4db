#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/ekf/detection/gyro_leap.hpp"
#include "services/ekf/detection/level_watch.hpp"
#include "services/ekf/detection/refusal_timer.hpp"
#include "services/ekf/detection/standing_motion.hpp"
#include "services/ekf/detection/start_up.hpp"
#include "services/ekf/detection/still_detector.hpp"
#include "services/ekf/detection/tilting_gyro.hpp"
#include "services/ekf/detection/turn_confirmation.hpp"
#include "services/ekf/filter/launch.hpp"
#include "services/ekf/filter/lost_axes.hpp"
#include "services/ekf/filter/lost_heading.hpp"
#include "services/ekf/filter/odom_smoother.hpp"
#include "services/ekf/filter/pose_history.hpp"
#include "services/ekf/filter/vertical_force.hpp"
#include "services/ekf/inputs/imu_noise.hpp"
#include "services/ekf/inputs/map_increment.hpp"
#include "services/ekf/inputs/wheel_odometer.hpp"
#include "services/ekf/model/estimate.hpp"
#include "services/ekf/model/mechanisation.hpp"
#include "services/ekf/wheel_faults/slip_judge.hpp"
#include "services/ekf/wheel_faults/wheel_watch.hpp"

namespace curbstone::ekf::filter {

/// Error-state Kalman filter of wheels and IMU. process_model.hpp and measurement_model.hpp have the equations,
/// error_state.hpp has the state. This class decides what is done when:
///
/// - Start-up (StartUp). Then every IMU sample predicts from the sample before, by the difference of the stamps; wheel
///   samples between the two are processed at their own times (Mechanisation).
/// - Every interval of the wheels corrects: while driving, with both wheels' speeds and the non-holonomic constraint;
///   while standing, with zero velocity and zero rate. A wheel that slips is left out (SlipJudge).
/// - The mapper's increments, if given, correct speed, gyro bias and with them the wheels' calibration.
/// - Without an IMU the filter coasts on the wheels, without wheels on the IMU and the constraint. It returns from both
///   by itself. While it coasts on the wheels, roll and pitch stay as they are, so the estimate counts as level.
/// - A gyro axis that is stuck is not used (LostAxes).
///
/// The correction of position and heading is spread over the distance that follows (OdomSmoother).
///
/// Takes samples in the order of their stamps (Sequencer, RewindingFilter). A stamp that goes back, or a step of more
/// than timing.max_jump, restarts the clock: the pose is kept, and the covariance of position, speed and tilt is
/// widened.
///
/// A value type without clock or threads: a copy is a check point from which it can continue.
class Filter {
 public:
  explicit Filter(const base::EkfConfig& config);

  /// Sets the last belief of a killed filter. Call it before any sample. The filter continues from it if the first IMU
  /// sample comes within kInheritance of it and its specific force fits, or, if no IMU is heard for kImuAwaited, a
  /// wheel sample does; otherwise the filter starts as if there were none.
  void inherit(const model::Belief& belief) { predecessor_ = belief; }
  static constexpr double kInheritance = 2.0;  ///< s
  static constexpr double kImuAwaited = 0.3;   ///< s

  /// Appends to `out` one estimate at the sample's stamp, once the filter has started.
  void add(const base::ImuSample& measured, std::vector<model::Estimate>& out);
  /// Appends estimates at the wheels' stamps, only while there is no IMU.
  void add(const base::WheelSample& sample, std::vector<model::Estimate>& out);
  /// Takes effect with the first IMU sample that is not before the increment's end.
  void add(const inputs::MapIncrement& increment) { pending_increment_ = increment; }

  [[nodiscard]] bool started() const { return started_; }
  /// Roll and pitch are known to start.level_sigma, or start.level_patience has passed.
  [[nodiscard]] bool level() const { return level_.level(); }
  /// Wheels that are withheld because they have been wrong for long.
  [[nodiscard]] const wheel_faults::WheelWatch& wheel_watch() const { return watch_; }
  /// Gyro axes that are not used because they are stuck. In the belief the bias of such an axis represents the rate;
  /// for another filter to inherit, take axes().with_restored_biases(belief()).
  [[nodiscard]] const LostAxes& axes() const { return axes_; }
  struct LeaptGyro {
    std::int64_t utime = 0;  ///< us, time of detection
    double rate = 0.0;       ///< rad/s
    int axis = 2;            ///< of base_link: ahead, left, up
  };
  /// The latest leap of the gyro's bias.
  [[nodiscard]] const std::optional<LeaptGyro>& gyro_leapt() const { return gyro_leapt_; }
  /// Whether the vertical part of the specific force is used.
  [[nodiscard]] const VerticalForce& vertical_force() const { return vertical_force_; }
  [[nodiscard]] const model::Belief& belief() const { return belief_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  using WheelStep = inputs::WheelOdometer::Step;

  [[nodiscard]] base::ImuSample usable_of(base::ImuSample measured);
  void update_noise(const base::ImuSample& sample);
  void start(const base::ImuSample& sample);
  void start(const base::WheelSample& sample);
  void begin(const model::Belief& first, double imu_turn);
  [[nodiscard]] bool continue_from_predecessor(const base::ImuSample& sample);
  [[nodiscard]] bool continue_from_predecessor(const base::WheelSample& sample);
  void continue_from(const model::Belief& predecessor, std::int64_t utime, std::optional<double> turn_rate);
  void restart_clock(std::int64_t utime);
  void update_stuck_axes();
  void turn_imu(double to);
  [[nodiscard]] model::TimedInertial in_body(const base::ImuSample& sample) const;
  void restore_if_not_finite();

  void process_pending_wheels(const model::TimedInertial* next);
  void update_standing(const model::Inertial& imu, double dt);
  void leave_standing();
  void start_launch();
  void cancel_launch();
  void advance_launch(std::int64_t utime, const model::TimedInertial* next);
  void update_level();

  void correct_with_wheels(WheelStep step, bool coasting);
  void correct_driving(const inputs::WheelInterval& interval);
  void compare_yaw_rates(const inputs::WheelInterval& interval);
  void correct_gyro_leap(const detection::GyroLeap::Leap& leap);
  void compare_tilt(const inputs::WheelInterval& interval);
  void restart_comparisons();
  void reset_yaw_rate_comparison();
  void check_launch(const inputs::WheelInterval& interval);
  void check_wheels(const inputs::WheelInterval& interval, const std::array<model::Observation, 2>& rows);
  [[nodiscard]] std::array<model::Observation, 2> observe_wheels(const inputs::WheelInterval& interval,
                                                                 const model::BodyMotion& motion) const;
  [[nodiscard]] bool gate_wheels(const inputs::WheelInterval& interval, std::array<model::Observation, 2>& rows);
  void reset_implausible_axle();
  [[nodiscard]] bool is_motion_wrong(const model::BodyMotion& motion, bool refused);
  void recover_from_made_up_wheels(const inputs::WheelInterval& interval);
  void count_fault_changes(const std::array<bool, 2>& before);
  [[nodiscard]] wheel_faults::WheelWatch::Finding resolve_dispute();
  [[nodiscard]] double trusted_speed(const inputs::WheelInterval& interval) const;
  void correct_coasting(const inputs::WheelInterval& interval);
  void correct_standing();
  void correct_without_wheels();
  void correct_with_map();
  void apply(const model::Observation& z);
  [[nodiscard]] model::Observation observe_constraint(const model::BodyMotion& motion);
  void reset_motion(double speed_sigma);

  void emit(const model::Inertial& imu, double dt, bool no_imu, std::vector<model::Estimate>& out);
  [[nodiscard]] bool wheels_missing(std::int64_t utime) const;
  [[nodiscard]] bool turn_confirmed(const model::Estimate& estimate) const;

  std::shared_ptr<const base::EkfConfig> config_;  // immutable: check points share it
  model::Geometry geometry_;
  inputs::ImuNoise imu_noise_;
  base::NoiseConfig noise_;  // as configured, or as measured where that is larger
  inputs::ImuNoise::Excess excess_;
  detection::StartUp start_up_;
  detection::StillDetector still_;
  inputs::WheelOdometer odometer_;
  model::Mechanisation mechanisation_;
  wheel_faults::SlipJudge slip_;
  wheel_faults::WheelWatch watch_;
  detection::TurnConfirmation turn_;
  detection::GyroLeap gyro_leap_;
  detection::TiltingGyro tilting_gyro_;
  std::optional<LeaptGyro> gyro_leapt_;
  detection::RefusalTimer wheels_refused_;
  detection::RefusalTimer constraint_refused_;
  OdomSmoother smoother_;
  PoseHistory recent_;  // uncorrected poses, to compare the mapper's increments with
  Counters counters_;

  bool started_ = false;
  bool standing_ = false;
  LostAxes axes_;
  VerticalForce vertical_force_;
  LostHeading heading_;
  detection::StandingMotion standing_motion_;
  std::optional<Launch> launch_;
  Eigen::Vector3d set_off_from_ = Eigen::Vector3d::Zero();  // m, position at the latest standstill
  bool wheels_rejected_ = false;                            // the wheels are disowned since a launch
  detection::LevelWatch level_;
  std::optional<model::Belief> predecessor_;
  model::Belief belief_;
  model::Belief last_good_;                  // the latest finite belief
  std::deque<base::WheelSample> pending_;    // waiting for the IMU sample after them
  std::optional<std::int64_t> last_wheels_;  // us
  std::int64_t emitted_ = 0;                 // us, of the latest estimate
  std::optional<inputs::MapIncrement> pending_increment_;
};

}  // namespace curbstone::ekf::filter
