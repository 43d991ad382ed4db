#pragma once

#include <Eigen/Core>
#include <cmath>
#include <curbstone/lidar_points_t.hpp>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

[[nodiscard]] constexpr double radians(double degrees) {
  return degrees * 0.017453292519943295;
}

/// Calls move(Eigen::Vector3d& point, std::size_t index) for each point, m in the lidar frame, and stores what it made
/// of it.
template <class Move>
void move_points(lidar_points_t& message, Move move) {
  for (std::size_t i = 0; i < message.x.size(); ++i) {
    Eigen::Vector3d point(message.x[i], message.y[i], message.z[i]);
    move(point, i);
    message.x[i] = static_cast<float>(point.x());
    message.y[i] = static_cast<float>(point.y());
    message.z[i] = static_cast<float>(point.z());
  }
}

/// Removes the points for which keep(point, index) is false, with all that belongs to them.
template <class Keep>
void keep_points(lidar_points_t& message, Keep keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < message.x.size(); ++i) {
    if (!keep(Eigen::Vector3d(message.x[i], message.y[i], message.z[i]), i)) continue;
    message.x[kept] = message.x[i];
    message.y[kept] = message.y[i];
    message.z[kept] = message.z[i];
    message.time_offset[kept] = message.time_offset[i];
    message.intensity[kept] = message.intensity[i];
    message.ring[kept] = message.ring[i];
    ++kept;
  }
  message.x.resize(kept);
  message.y.resize(kept);
  message.z.resize(kept);
  message.time_offset.resize(kept);
  message.intensity.resize(kept);
  message.ring.resize(kept);
  message.num_points = static_cast<std::int32_t>(kept);
}

/// The same direction at another range, m. A point at the origin stays there.
inline void set_range(Eigen::Vector3d& point, double range) {
  const double norm = point.norm();
  if (norm > 0) point *= range / norm;
}

/// deg, counter-clockwise from ahead.
[[nodiscard]] inline double azimuth_degrees(const Eigen::Vector3d& point) {
  return std::atan2(point.y(), point.x()) / radians(1.0);
}

/// A thing with upright sides, m in the lidar frame.
struct Box {
  Eigen::Vector3d low, high;
};

/// What a box hides is seen on the box instead, with 2 cm of noise. Points nearer than the box stay.
void put_in_sight(const Box& box, simulate::numerics::Random& random, lidar_points_t& message);

}  // namespace curbstone::bench::sensor_faults::catalogue
