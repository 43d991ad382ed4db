#pragma once

#include <array>

#include "common/config/vehicle.hpp"
#include "services/ekf/model/correction.hpp"
#include "services/ekf/model/process_model.hpp"

namespace curbstone::ekf::model {

/// Mounting and dimensions, in body axes.
struct Geometry {
  explicit Geometry(const VehicleConfig& vehicle)
      : R_base_imu(vehicle.T_base_imu().linear()),
        to_base(-vehicle.T_base_imu().translation()),
        wheel_radius(vehicle.wheel_radius),
        track_width(vehicle.track_width) {}
  Eigen::Matrix3d R_base_imu;
  Eigen::Vector3d to_base;  ///< l: from the IMU to base_link, m
  double wheel_radius;      ///< m
  double track_width;       ///< m
};

/// Motion of base_link in body axes, the filter's mean over some interval.
struct BodyMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< v + w x l, m/s
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  ///< w = gyro - bg, rad/s
};

/// base_link's motion at an instant, from the gyro's reading (body axes).
[[nodiscard]] BodyMotion body_motion(const NavState& state, const Eigen::Vector3d& gyro, const Geometry& geometry);

enum class Wheel { kLeft = 0, kRight = 1 };

/// Yaw rate, rad/s, from the speeds of the left and the right wheel (m/s, with the configured radius) and the estimated
/// scales.
[[nodiscard]] double wheel_yaw_rate(const NavState& state, const std::array<double, 2>& speed,
                                    const Geometry& geometry);

/// A wheel's speed over ground, as counted with the configured radius (m/s), against the motion over the same interval:
///     u = (v_x -+ w_z b (1 + s_track) / 2) / (1 + s_wheel)        (- for the left wheel)
/// The interval's mean is compared with the filter's mean; H is evaluated at the interval's end (the error hardly
/// changes within it).
[[nodiscard]] Observation observe_wheel(const NavState& state, const BodyMotion& motion, Wheel wheel, double speed,
                                        double sigma, const Geometry& geometry);

/// Non-holonomic constraint: the axle, at a = (state.axle, 0, 0), rolls in the direction of its course c, neither
/// sideways of it (axis 1) nor off the ground (axis 2):  (v + w x a)_axis = c_axis v_x
/// The vertical axis does not correct the axle's place: a vehicle on springs does not pitch about its axle. (If it did,
/// the heaving of a real car would cause an error of 0.3 m in seconds, with its effect in the next bend.)
[[nodiscard]] Observation observe_no_motion_along(int axis, const NavState& state, const BodyMotion& motion,
                                                  double sigma, const Geometry& geometry);

/// Mean forward speed of base_link (m/s), for use without an IMU, where only the wheels show the yaw rate.
[[nodiscard]] Observation observe_forward_speed(const NavState& state, const BodyMotion& motion, double speed,
                                                double sigma);

/// Motion of base_link over the last `dt` s: measured (`T_begin_end`, with its covariance in the axes at the end)
/// against believed; rows are translation, rotation. Errors of speed and gyro bias are taken as constant meanwhile;
/// `motion` is the mean.
[[nodiscard]] Observation observe_increment(const Pose& T_begin_end, const Eigen::Matrix<double, 6, 6>& covariance,
                                            const Pose& believed, double dt, const BodyMotion& motion,
                                            const Geometry& geometry);

/// Zero-velocity update. The vehicle does not turn either, so there is no lever arm.
[[nodiscard]] Observation observe_standing_velocity(const NavState& state, double sigma);

/// Zero-rate update: the gyro's mean reading at standstill (body axes) is its bias.
[[nodiscard]] Observation observe_standing_rate(const NavState& state, const Eigen::Vector3d& gyro, double sigma);

/// Levelling: the specific force minus gravity's part is `acceleration` (both body axes): acc = a - R^T g + ba.
[[nodiscard]] Observation observe_gravity(const NavState& state, const Eigen::Vector3d& specific_force,
                                          const Eigen::Vector3d& acceleration, double sigma);

}  // namespace curbstone::ekf::model
