#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <optional>

#include "common/config/vehicle.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/mounting/turn_scale.hpp"

namespace curbstone::ekf::mounting {

/// Whether IMU and wheels are on the vehicle as its file says: the usual mistakes on a new one. It asks the sensors
/// alone, for a filter with a wrong configuration believes nonsense, and finds wheels to slip, or itself to drift.
///
/// - Gravity: over kGravityMemory the specific force points up, and is as large as gravity. No vehicle drives tilted
///   by kMaxTilt, nor do bends look so.
/// - Turn: the wheels' yaw rate is a multiple of the gyro's (TurnFit). Where it is about -1 in two stretches of turning
///   in a row, and explains what the speed does not, left and right are swapped, both wheels count backwards, or the
///   gyro's sign is wrong. Where it stays another one than 1, the track width is wrong or the gyro's scale (TurnScale).
/// - Forward: the changes of horizontal specific force are those of the wheels' speed (ahead) and of speed times yaw
///   rate (to the left), turned by what vehicle.imu's yaw lacks: least squares of complex numbers. Believed where it
///   explains most of the force, with a plausible gain.
/// - Hand: where it is their mirror image, turned somehow, that explains most, and the motion itself clearly less (it
///   takes bends: ahead alone both do as well), two axes of the IMU are swapped, or one has the wrong sign.
/// - Lying gyro: it is the rate about a level axis that goes with the wheels' yaw rate, and that about the vertical
///   does not: another axis of the gyro is up than the file says.
///
/// A value type; one thread. Samples in the order of their stamps, base_link's axes as configured.
class MountingWatch {
 public:
  static constexpr double kGravityMemory = 5.0;  ///< s
  static constexpr double kMaxTilt = 0.8;        ///< rad; bends of 0.8 g look like 0.68
  static constexpr double kMaxYaw = 1.05;        ///< rad

  explicit MountingWatch(const VehicleConfig& vehicle);

  /// Not those of a gyro that is stuck.
  void add(const base::ImuSample& sample);
  void add(const base::WheelSample& sample);

  /// The axis of the IMU that points up, 1 of length, imu frame, where that is another one than configured.
  [[nodiscard]] std::optional<Eigen::Vector3d> wrong_up() const;
  /// m/s^2, the mean of the specific force where that is not gravity: another unit, or a broken accelerometer.
  [[nodiscard]] std::optional<double> wrong_gravity() const;

  // The others are said only where gravity points up as configured.

  /// Wheels and gyro turn opposite ways.
  [[nodiscard]] bool turns_opposite() const { return opposite_ && !tilted_; }
  /// How many times as far as the gyro the wheels turn, where that is wrong. Not where they turn opposite ways.
  [[nodiscard]] std::optional<double> wrong_turn_scale() const;
  /// That multiple is beyond any track width, or the gyro lies: its rate has nothing to do with how the vehicle turns.
  [[nodiscard]] bool gyro_is_wrong() const;
  /// The axis of the gyro, 1 of length, imu frame, that points up, where that is another one than the accelerometer's.
  [[nodiscard]] std::optional<Eigen::Vector3d> lying_gyro() const;
  /// As what the IMU measures ahead (x) and to the left (y), where that is mirrored: (0, 1) means that its x is the
  /// vehicle's left. No rotation in vehicle.imu mends that.
  [[nodiscard]] std::optional<Eigen::Vector2d> mirrored() const;
  /// rad, what vehicle.imu's yaw lacks; about pi where both wheels count backwards.
  [[nodiscard]] std::optional<double> missing_yaw() const;

 private:
  using Complex = std::complex<double>;  // ahead, to the left
  struct Interval {
    double seconds = 0.0;
    double speed = 0.0;                                    // m/s, mean of both wheels
    double wheel_rate = 0.0;                               // rad/s, by the wheels
    double gyro_rate = 0.0;                                // rad/s
    Eigen::Vector2d level_rate = Eigen::Vector2d::Zero();  // rad/s, about x and y
    Eigen::Vector2d force = Eigen::Vector2d::Zero();       // m/s^2
  };
  void begin_again(const base::WheelSample& sample);
  void judge(const Interval& interval);
  void judge_turn(const Interval& interval);
  void judge_lying(const Interval& interval);
  void judge_hand(double seconds, double motion);
  void judge_forward(const Interval& before, const Interval& interval);

  Eigen::Matrix3d R_base_imu_;
  double radius_, track_;  // m

  std::optional<base::ImuSample> last_imu_;
  double gravity_seconds_ = 0.0;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();  // m/s^2, base_link: mean specific force
  bool tilted_ = false;

  std::optional<base::WheelSample> begin_;
  int imu_samples_ = 0;  // of the present interval, with their sums
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_sum_ = Eigen::Vector3d::Zero();
  std::optional<Interval> before_;

  TurnFit turn_;
  int against_ = 0;  // stretches in a row in which they turned opposite ways
  bool opposite_ = false;
  TurnScale turn_scale_;
  TurnFit upright_;                                  // of the rate about z,
  std::array<TurnFit, 2> level_;                     // x, y, of late
  double turning_ = 0.0;                             // s, of late
  Eigen::Vector2d lying_ = Eigen::Vector2d::Zero();  // its axis

  double mean_seconds_ = 0.0;
  Complex mean_force_, mean_motion_;                 // what is slow: tilt, bias
  double force_square_ = 0.0, motion_square_ = 0.0;  // integrals, m^2/s^3
  Complex product_, mirror_product_;                 // of the force with the motion, and with its mirror image
  bool turned_ = false;
  double hand_seconds_ = 0.0, hand_motion_ = 0.0;  // without a break, in which the mirror image explains it
  bool mirrored_ = false;
};

}  // namespace curbstone::ekf::mounting
