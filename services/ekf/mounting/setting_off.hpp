#pragma once

#include <Eigen/Geometry>
#include <complex>
#include <deque>
#include <optional>

#include "common/config/vehicle.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::mounting {

/// Measures the yaw of the IMU's mounting each time the vehicle sets off from a standstill.
///
/// At rest the mean specific force and the gyro's bias are known. From then on the IMU alone gives the way that it
/// moves, in its own axes, for some seconds: gyro and accelerometer, less what they showed at rest, are integrated
/// twice. The wheels move the vehicle ahead. The angle between both ways is the error of vehicle.imu's yaw, to 2 deg
/// (tests SettingOff): slopes and the tilt of a vehicle that sets off do not matter, as the gyro shows them.
///
/// It is measured after kTravel and after twice that. Not judged: a start in which both differ by kUneven, in which the
/// IMU shakes too hard (kMaxSigma), that takes longer than kMaxDuration, after less than kRest of rest, with a gap,
/// with ways of another length, or where the wheels turn otherwise than the gyro (a wheel slips, or is wrong).
///
/// A value type; one thread. Samples in the order of their stamps, base_link's axes as configured.
class SettingOff {
 public:
  static constexpr double kRest = 1.0;         ///< s
  static constexpr double kMaxDuration = 5.0;  ///< s
  static constexpr double kTravel = 0.3;       ///< m
  static constexpr double kUneven = 0.1;       ///< rad
  static constexpr double kMaxSigma = 0.05;    ///< rad, by the accelerometer's white noise

  struct Start {
    double yaw = 0.0;    ///< rad, -pi to pi, correction to vehicle.imu's; about pi: or the wheels count backwards
    bool ahead = false;  ///< by the wheels
  };

  explicit SettingOff(const VehicleConfig& vehicle);

  void add(const base::ImuSample& sample);
  /// Returns each start that is judged once.
  [[nodiscard]] std::optional<Start> add(const base::WheelSample& sample);

 private:
  struct Inertial {
    std::int64_t utime = 0;  // us
    Eigen::Vector3d rate, force;
  };
  [[nodiscard]] double travel_since(const base::WheelSample& begin, const base::WheelSample& sample) const;
  void roll(const base::WheelSample& sample);
  void begin(const base::WheelSample& sample);
  void integrate(const Inertial& sample);
  [[nodiscard]] std::optional<Start> judge(const base::WheelSample& sample);
  [[nodiscard]] std::optional<double> measured(double left, double right) const;
  [[nodiscard]] double noise_of_way() const;

  Eigen::Matrix3d R_base_imu_;
  Eigen::Vector2d lever_;  // m, base_link: where the IMU is
  double radius_, track_;  // m

  bool sets_off_ = false;
  std::optional<base::WheelSample> still_since_;  // the wheels have not turned since then
  std::optional<base::WheelSample> latest_;
  std::deque<Inertial> at_rest_;  // of the last seconds

  std::int64_t began_ = 0;                              // us
  std::int64_t last_ = 0;                               // us, of the last sample that was integrated
  Eigen::Vector3d rest_rate_, rest_force_;              // means
  Eigen::Quaterniond R_rest_body_;                      // since the rest
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();  // m/s, axes of base_link at rest
  std::complex<double> way_;                            // m, ahead and to the left, by the IMU
  double turn_ = 0.0;                                   // rad, by the gyro
  std::optional<double> first_;                         // rad, after kTravel
  // The accelerometer's noise, by the changes from sample to sample.
  Eigen::Vector3d last_force_;
  double changes_ = 0.0;  // m^2/s^4, sum of squares, level axes
  int samples_ = 0;
  double seconds_ = 0.0;
};

}  // namespace curbstone::ekf::mounting
