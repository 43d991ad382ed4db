#pragma once

#include <ceres/rotation.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <utility>

#include "common/geometry/gravity.hpp"
#include "tools/calibrate/calibration_noise.hpp"
#include "tools/calibrate/segment.hpp"

/// Residuals of the sensors' agreement, for automatic differentiation by Ceres. Parameters:
///   wheels              radii, left and right, and track, m
///   lidar, imu          T_base_lidar, T_base_imu: x y z in m, roll pitch yaw in rad
///   gyro_bias           rad/s, in addition to the one subtracted before; accelerometer_bias m/s^2
///   level               rad, about x and y: of the map against gravity
///   camber              rad, roll of the road under the vehicle: the same all drive long
/// Each lists the kinds of its residuals in kKinds; residuals are in sigmas of `noise`. Included by
/// calibration_solver.cpp only.
namespace curbstone::calibrate::residuals {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

inline const double kStraight = 1.0 + 2.0 * std::cos(0.02);  // trace of a rotation by 0.02 rad

template <class T>
Matrix3<T> from_rpy(const T* rpy) {
  return (Eigen::AngleAxis<T>(rpy[2], Vector3<T>::UnitZ()) * Eigen::AngleAxis<T>(rpy[1], Vector3<T>::UnitY()) *
          Eigen::AngleAxis<T>(rpy[0], Vector3<T>::UnitX()))
      .toRotationMatrix();
}

template <class T>
Vector3<T> log_of(const Matrix3<T>& R) {
  Vector3<T> out;
  ceres::RotationMatrixToAngleAxis(ceres::ColumnMajorAdapter3x3(R.data()), out.data());
  return out;
}

template <class T>
Matrix3<T> exp_of(const Vector3<T>& v) {
  Matrix3<T> R;
  ceres::AngleAxisToRotationMatrix(v.data(), ceres::ColumnMajorAdapter3x3(R.data()));
  return R;
}

/// base_link's motion by the LiDAR against the arcs that the wheels rolled. A vehicle turns about the vertical, which
/// is base_link's z only on a flat road. On a road with constant camber, the LiDAR appears to be mounted at that angle.
struct WheelsAgainstLidar {
  const CalibrationSegment& segment;
  double configured_track;
  const NoiseLevels& noise;
  template <class T>
  bool operator()(const T* wheels, const T* lidar, const T* camber, T* residual) const {
    T x(0.0), y(0.0), heading(0.0);
    for (const auto& turned : segment.wheels) {
      const T left = wheels[0] * turned[0];
      const T right = wheels[1] * turned[1];
      const T turn = (right - left) / wheels[2];
      const T way = 0.5 * (left + right);
      x += way * cos(heading + 0.5 * turn);
      y += way * sin(heading + 0.5 * turn);
      heading += turn;
    }
    const Matrix3<T> R = from_rpy(lidar + 3);
    const Vector3<T> t(lidar[0], lidar[1], lidar[2]);
    const Pose L = segment.T_begin_end();
    const Matrix3<T> R_base = R * L.linear().cast<T>() * R.transpose();
    const Vector3<T> t_base = t + R * L.translation().cast<T>() - R_base * t;
    const Vector3<T> turned = log_of(R_base);
    residual[0] = (t_base.x() - x) / noise[kAlong];
    residual[1] = (t_base.y() - y) / noise[kSideways];
    residual[2] = t_base.z() / noise[kUpwards];
    residual[3] = turned.x() / noise[kTilt];
    residual[4] = (turned.y() - camber[0] * turned.z()) / noise[kTilt];
    // In metres of wheel path, which carry the error. A piece that hardly turns constrains the ratio of the radii. It
    // would constrain the track by noise only, which would bias the track towards a smaller residual.
    const double seen = L.linear().trace() > kStraight ? 0.0 : 1.0;
    const T track = seen * wheels[2] + (1.0 - seen) * configured_track;
    residual[5] = (turned.z() * track - heading * wheels[2]) / noise[kTurn];
    return true;
  }
  static constexpr std::array kKinds = {kAlong, kSideways, kUpwards, kTilt, kTilt, kTurn};
};

struct GyroAgainstLidar {
  const CalibrationSegment& segment;
  const NoiseLevels& noise;
  template <class T>
  bool operator()(const T* lidar, const T* imu, const T* gyro_bias, T* residual) const {
    const Matrix3<T> Q = from_rpy(imu + 3).transpose() * from_rpy(lidar + 3);  // lidar to imu
    const Vector3<T> bias(gyro_bias[0], gyro_bias[1], gyro_bias[2]);
    const Matrix3<T> by_gyro =
        segment.imu.rotation.toRotationMatrix().cast<T>() * exp_of<T>(segment.imu.rotation_by_bias.cast<T>() * bias);
    const Matrix3<T> by_lidar = Q * segment.T_begin_end().linear().cast<T>() * Q.transpose();
    const Vector3<T> error = log_of<T>(by_gyro.transpose() * by_lidar);
    for (int i = 0; i < 3; ++i) residual[i] = error[i] / noise[kGyro];
    return true;
  }
  static constexpr std::array kKinds = {kGyro, kGyro, kGyro};
};

/// The IMU's mean velocities in one piece and in the next: their difference is explained by the accelerometer and
/// gravity.
struct AccelerometerAgainstLidar {
  const CalibrationSegment& a;
  const CalibrationSegment& b;
  const NoiseLevels& noise;
  template <class T>
  bool operator()(const T* lidar, const T* imu, const T* accelerometer_bias, const T* level, T* residual) const {
    const Matrix3<T> R_base_lidar = from_rpy(lidar + 3);
    const Matrix3<T> R_lidar_imu = R_base_lidar.transpose() * from_rpy(imu + 3);
    const Vector3<T> arm =
        R_base_lidar.transpose() * Vector3<T>(imu[0] - lidar[0], imu[1] - lidar[1], imu[2] - lidar[2]);
    const auto at = [&](const Pose& T_map_lidar) -> Vector3<T> {
      return T_map_lidar.translation().cast<T>() + T_map_lidar.linear().cast<T>() * arm;
    };
    const Vector3<T> bias(accelerometer_bias[0], accelerometer_bias[1], accelerometer_bias[2]);
    const Vector3<T> gravity =
        exp_of<T>(Vector3<T>(level[0], level[1], T(0.0))) * Vector3<T>(T(0.0), T(0.0), T(-kGravity));
    const Matrix3<T> R_a = a.T_map_begin.linear().cast<T>() * R_lidar_imu;
    const Matrix3<T> R_b = b.T_map_begin.linear().cast<T>() * R_lidar_imu;
    const T da(a.duration), db(b.duration);
    const Vector3<T> seen = (at(b.T_map_end) - at(b.T_map_begin)) / db - (at(a.T_map_end) - at(a.T_map_begin)) / da;
    const Vector3<T> felt = 0.5 * (da + db) * gravity + R_b * (b.imu.position.cast<T>() / db - 0.5 * db * bias) -
                            R_a * (a.imu.position.cast<T>() / da - 0.5 * da * bias) +
                            R_a * (a.imu.velocity.cast<T>() - da * bias);
    for (int i = 0; i < 3; ++i) residual[i] = (seen[i] - felt[i]) / noise[kSpeed];
    return true;
  }
  static constexpr std::array kKinds = {kSpeed, kSpeed, kSpeed};
};

/// Derivatives by so many parameters at a time, for all residuals alike: the functions above are compiled for one
/// number instead of each residual's own, which takes much of the time of this file.
inline constexpr int kDerivatives = 4;

/// A residual of `Count` blocks of parameters, as Ceres asks for it where their number is not of the type.
template <class Functor, std::size_t Count>
struct Listed {
  Functor functor;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    return call(parameters, residual, std::make_index_sequence<Count>());
  }

 private:
  template <class T, std::size_t... I>
  bool call(T const* const* parameters, T* residual, std::index_sequence<I...>) const {
    return functor(parameters[I]..., residual);
  }
};

}  // namespace curbstone::calibrate::residuals
