#pragma once

#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/bench/sensor_faults/catalogue/catalogue.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

inline Fault fault_named(const std::string& name) {
  for (const Fault& fault : all_faults())
    if (fault.name == name) return fault;
  throw std::runtime_error("no fault is called " + name);
}

inline wheels_t some_wheels(std::int64_t utime = 1'000'000) {
  wheels_t m{};
  m.utime = utime;
  m.counts[0] = 4096, m.counts[1] = 8192;
  m.angle[0] = 6.25, m.angle[1] = 12.5;
  m.speed[0] = 10, m.speed[1] = 20;
  m.enabled = true;
  return m;
}

inline imu_t some_imu(std::int64_t utime = 1'000'000) {
  imu_t m{};
  m.utime = utime;
  for (int axis = 0; axis < 3; ++axis) m.acceleration[axis] = axis + 1, m.angular_rate[axis] = 0.1 * (axis + 1);
  return m;
}

struct SomePoint {
  float x, y, z;
};

/// `points` in m; rings and intensities count up.
inline lidar_points_t some_points(const std::vector<SomePoint>& points, std::int64_t utime = 1'000'000) {
  lidar_points_t m{};
  m.utime = utime;
  m.num_points = static_cast<std::int32_t>(points.size());
  for (const SomePoint& point : points) {
    m.x.push_back(point.x);
    m.y.push_back(point.y);
    m.z.push_back(point.z);
    m.ring.push_back(static_cast<std::uint8_t>(m.ring.size() % 16));
    m.intensity.push_back(static_cast<std::uint8_t>(m.intensity.size() % 256));
    m.time_offset.push_back(1e-6F * static_cast<float>(m.time_offset.size()));
  }
  return m;
}

/// What the fault makes of one message at t; empty if it is not sent.
inline std::vector<wheels_t> after(const Fault& fault, wheels_t m, double t = 20) {
  return fault.make().wheels(t, m) ? std::vector{m} : std::vector<wheels_t>{};
}
inline std::vector<imu_t> after(const Fault& fault, imu_t m, double t = 20) {
  return fault.make().imu(t, m) ? std::vector{m} : std::vector<imu_t>{};
}
inline std::vector<lidar_points_t> after(const Fault& fault, lidar_points_t m, double t = 20) {
  return fault.make().lidar(t, m) ? std::vector{m} : std::vector<lidar_points_t>{};
}

}  // namespace curbstone::bench::sensor_faults::catalogue
