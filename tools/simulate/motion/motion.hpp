#pragma once

#include <array>
#include <memory>

#include "common/geometry/geometry.hpp"
#include "common/geometry/gravity.hpp"

namespace curbstone::simulate::motion {

/// The true pose of the vehicle at any time, from which all sensor data are simulated. Twice differentiable. Immutable;
/// safe from any thread.
class Motion {
 public:
  virtual ~Motion() = default;
  /// `t` in s since the drive began.
  [[nodiscard]] virtual Pose T_world_base(double t) const = 0;
};

/// The measurement of an ideal, rigidly mounted IMU.
struct Inertia {
  Eigen::Vector3d specific_force;  ///< m/s^2, imu frame: +g on the up axis at rest
  Eigen::Vector3d angular_rate;    ///< rad/s, imu frame
};
[[nodiscard]] Inertia inertia_at(const Motion& motion, const Pose& T_base_imu, double t);

/// Signed distance that a point of the vehicle moves along the vehicle's heading from t0 to t1, m; a wheel at that
/// point rolls that distance.
[[nodiscard]] double rolled_distance(const Motion& motion, const Eigen::Vector3d& point_base, double t0, double t1);
/// That of two points, such as both wheels, for the price of one.
[[nodiscard]] std::array<double, 2> rolled_distances(const Motion& motion,
                                                     const std::array<Eigen::Vector3d, 2>& points_base, double t0,
                                                     double t1);

}  // namespace curbstone::simulate::motion
