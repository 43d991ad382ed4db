#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "common/config/vehicle.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/mounting/mean_lean.hpp"
#include "services/ekf/mounting/setting_off.hpp"
#include "services/ekf/mounting/turn_scale.hpp"

namespace curbstone::ekf::mounting {

/// Checks that IMU and wheels are mounted as the vehicle's file says, to find the usual mistakes on a new vehicle. It
/// uses the sensors alone: with a wrong configuration the filter's state is wrong, and it takes the wheels for slipping
/// or itself for drifting.
///
/// - Gravity: averaged over kGravityMemory the specific force points up, and is as large as gravity. No vehicle drives
///   tilted by kMaxTilt, and no bend looks like it. Less than that shows in the mean of a drive (MeanLean).
/// - Turn: the wheels' yaw rate is a multiple of the gyro's (TurnFit). If the multiple is about -1 in two consecutive
///   stretches of turning, and explains what the speed does not, then left and right are swapped, both wheels count
///   backwards, or the gyro's sign is wrong. If it stays at another value than 1, the track width or the gyro's scale
///   is wrong (TurnScale).
/// - Forward: the changes of horizontal specific force are those of the wheels' speed (ahead) and of speed times yaw
///   rate (to the left), rotated by the error of vehicle.imu's yaw: least squares of complex numbers. Accepted where it
///   explains most of the force, with a plausible gain. Each start from a standstill shows that error at once
///   (SettingOff).
/// - Handedness: if the mirror image of that motion, rotated by any angle, explains most of the force, and the motion
///   itself clearly less, then two axes of the IMU are swapped, or one has the wrong sign. (This needs bends: without
///   them both explain it equally.)
/// - The gyro's axes: if the rate about a level axis is proportional to the wheels' yaw rate, and the rate about the
///   vertical is not, then another axis of the gyro points up than the file says.
///
/// A value type; one thread. Samples in the order of their stamps, base_link's axes as configured.
class MountingWatch {
 public:
  static constexpr double kGravityMemory = 5.0;  ///< s
  static constexpr double kFirstForce = 0.5;     ///< s after which its magnitude is judged: before the filter starts
  static constexpr double kMaxTilt = 0.8;        ///< rad; bends of 0.8 g look like 0.68
  static constexpr double kMaxYaw = 1.05;        ///< rad, by the forces of a drive
  static constexpr double kMaxStartYaw = 0.15;   ///< rad, by a start: healthy vehicles show less than 0.03
  static constexpr double kBackwards = 2.36;  ///< rad, of missing_yaw(): from here on both wheels may count backwards

  /// A mistake that is found. Its values are told by the functions below.
  enum class Verdict {
    kWrongUp,               ///< wrong_up()
    kWrongGravity,          ///< wrong_gravity()
    kLeans,                 ///< leans(), not with either of the above
    kWheelsCountBackwards,  ///< wheels_count_backwards(): nothing below is said then
    kTurnsOpposite,         ///< turns_opposite()
    kMirrored,              ///< mirrored()
    kWrongGyroUp,           ///< wrong_gyro_up()
    kGyroIsWrong,           ///< gyro_is_wrong(), by its scale
    kWrongTurnScale,        ///< wrong_turn_scale(), of a gyro that is not wrong
    kSetsOffTheOtherWay,    ///< is_undecided()
    kMissingYaw,            ///< missing_yaw(), decided
  };

  explicit MountingWatch(const VehicleConfig& vehicle);

  /// Do not pass samples of a gyro that is stuck.
  void add(const base::ImuSample& sample);
  void add(const base::WheelSample& sample);

  /// All that is wrong now, in the order of Verdict: what is to be told to an operator.
  [[nodiscard]] std::vector<Verdict> verdicts() const;
  /// Unit vector, imu frame: the axis of the IMU that points up, if it is not the configured one.
  [[nodiscard]] std::optional<Eigen::Vector3d> wrong_up() const;
  /// The same before it is certain: from the first kFirstForce s on. A filter should not start so.
  [[nodiscard]] bool may_have_wrong_up() const;
  /// m/s^2, mean of the specific force if it is not gravity: another unit, or a broken accelerometer.
  [[nodiscard]] std::optional<double> wrong_gravity() const;
  /// rad, to the right and backwards, by which the vehicle leans all along, as no street does.
  [[nodiscard]] std::optional<Eigen::Vector2d> leans() const { return lean_.wrong(); }

  // The checks below report only while gravity points up as configured.

  /// Wheels and gyro turn opposite ways.
  [[nodiscard]] bool turns_opposite() const { return opposite_ && !tilted_; }
  /// The wheels' turn as a multiple of the gyro's, if it is wrong. Not while they turn opposite ways.
  [[nodiscard]] std::optional<double> wrong_turn_scale() const;
  /// That multiple is beyond any track width, or wrong_gyro_up(): its rate is unrelated to the vehicle's turn.
  [[nodiscard]] bool gyro_is_wrong() const;
  /// Unit vector, imu frame: the axis of the gyro that points up, if it is not the accelerometer's.
  [[nodiscard]] std::optional<Eigen::Vector3d> wrong_gyro_up() const;
  /// The IMU's reading of a force ahead (x) and to the left (y), if the axes are mirrored: (0, 1) means that its x is
  /// the vehicle's left. No rotation in vehicle.imu corrects that.
  [[nodiscard]] std::optional<Eigen::Vector2d> mirrored() const;
  /// rad, correction to vehicle.imu's yaw; about pi where both wheels count backwards.
  [[nodiscard]] std::optional<double> missing_yaw() const;
  /// missing_yaw() is about pi.
  [[nodiscard]] bool goes_backwards() const;
  /// Then it is the IMU, if wheels and gyro have turned the same way since; else the wheels. Until the first bend shows
  /// that, the vehicle is believed to have set off forwards.
  [[nodiscard]] bool imu_looks_backwards() const {
    return goes_backwards() && (sense_ == 0 ? set_off_ahead_ : sense_ > 0);
  }
  /// It is the wheels: a bend has shown it.
  [[nodiscard]] bool wheels_count_backwards() const { return goes_backwards() && (sense_ < 0 || turns_opposite()); }
  /// No bend has shown that yet.
  [[nodiscard]] bool is_undecided() const { return goes_backwards() && sense_ == 0; }
  /// rad, that the samples of the IMU are to be turned by: missing_yaw(), unless the wheels may be what is wrong. Small
  /// changes are not followed.
  [[nodiscard]] double imu_turn() const { return imu_turn_; }
  /// The sample as an IMU would show it that is mounted as vehicle.imu says: turned by imu_turn().
  [[nodiscard]] base::ImuSample turned(base::ImuSample sample) const;
  /// As an earlier watch has found it, until the next start from a standstill.
  void begin_with(double imu_turn);
  /// Another axis points up, or its axes are not right-handed: the IMU's samples only harm.
  [[nodiscard]] bool imu_is_misplaced() const { return tilted_ || mirrored(); }

 private:
  using Complex = std::complex<double>;  // ahead, to the left
  struct Interval {
    double seconds = 0.0;
    double speed = 0.0;                                    // m/s, mean of both wheels
    double wheel_rate = 0.0;                               // rad/s, by the wheels
    double gyro_rate = 0.0;                                // rad/s
    Eigen::Vector2d level_rate = Eigen::Vector2d::Zero();  // rad/s, about x and y
    Eigen::Vector2d force = Eigen::Vector2d::Zero();       // m/s^2
    double up = 0.0;                                       // m/s^2, likewise
  };
  [[nodiscard]] bool gravity_points_aside() const;
  void restart_interval(const base::WheelSample& sample);
  void check(const Interval& interval);
  void check_turn(const Interval& interval);
  void check_gyro_up(const Interval& interval);
  void check_handedness(double seconds, double motion);
  void note_start(const SettingOff::Start& start);
  void check_sense(const Interval& interval);
  void update_turn();
  void check_forward(const Interval& before, const Interval& interval);

  Eigen::Matrix3d R_base_imu_;
  double radius_, track_;  // m

  std::optional<base::ImuSample> last_imu_;
  double gravity_seconds_ = 0.0;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();  // m/s^2, base_link: mean specific force
  bool tilted_ = false;
  MeanLean lean_;

  std::optional<base::WheelSample> begin_;
  int imu_samples_ = 0;  // in the current interval, with their sums
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_sum_ = Eigen::Vector3d::Zero();
  std::optional<Interval> before_;

  TurnFit turn_;
  int opposite_stretches_ = 0;  // consecutive stretches in which they turned opposite ways
  bool opposite_ = false;
  TurnScale turn_scale_;
  TurnFit upright_;                                    // of the rate about z
  std::array<TurnFit, 2> level_;                       // x, y, over the last seconds
  double turning_ = 0.0;                               // s, over the last seconds
  Eigen::Vector2d gyro_up_ = Eigen::Vector2d::Zero();  // its axis that points up; 0: the configured one

  double mean_seconds_ = 0.0;
  Complex mean_force_, mean_motion_;                 // slow part: tilt, bias
  double force_square_ = 0.0, motion_square_ = 0.0;  // integrals, m^2/s^3
  Complex product_, mirror_product_;                 // of the force with the motion, and with its mirror image
  bool yaw_is_wrong_ = false;
  SettingOff setting_off_;
  std::optional<double> start_yaw_;  // rad, by the latest start, if it is wrong
  bool set_off_ahead_ = false;       // by the wheels, then
  double imu_turn_ = 0.0;            // rad
  TurnFit sense_fit_;                // since then
  int sense_ = 0;                    // 1: wheels and gyro turned the same way since then, -1: opposite ways
  double mirrored_seconds_ = 0.0, mirrored_motion_ = 0.0;  // in a row, in which the mirror image explains the force
  bool mirrored_ = false;
};

}  // namespace curbstone::ekf::mounting
