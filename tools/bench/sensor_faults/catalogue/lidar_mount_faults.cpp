#include <algorithm>
#include <cmath>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

namespace {

/// The points are turned counter-clockwise by degrees(t) about the vertical.
template <class Degrees>
auto yawed(Degrees degrees) {
  return [degrees](double t, lidar_points_t& m) {
    const double angle = radians(degrees(t));
    const double c = std::cos(angle), s = std::sin(angle);
    move_points(m, [c, s](Eigen::Vector3d& p, std::size_t) {
      p = Eigen::Vector3d(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
    });
  };
}

auto sine(double degrees, double hertz) {
  return [=](double t) { return degrees * std::sin(6.283185307179586 * hertz * t); };
}

/// From one end to the other at once, and back.
auto play(double degrees, double hertz) {
  return [=](double t) { return std::copysign(degrees, std::sin(6.283185307179586 * hertz * t)); };
}

}  // namespace

std::vector<Fault> lidar_mount_faults() {
  const auto fault = [](std::string name, std::string words, auto degrees) {
    return lidar_fault(std::move(name), std::move(words), kOnTheWay, yawed(degrees));
  };
  return {
      fault("mount slips 5 deg", "a knock turns it by 5 deg about the vertical", [](double) { return 5.0; }),
      fault("mount slips 14 deg", "a knock turns it by 14 deg about the vertical", [](double) { return 14.0; }),
      fault("mount creeps", "it turns by 0.5 deg each second, up to 20 deg",
            [](double t) { return std::min(20.0, 0.5 * (t - kOnTheWay)); }),
      fault("mount play 1.5 deg, 0.4 Hz", "it jumps by +-1.5 deg in yaw, 0.4 times a second", play(1.5, 0.4)),
      fault("mount play 1.5 deg, 2 Hz", "it jumps by +-1.5 deg in yaw, twice a second", play(1.5, 2.0)),
      fault("mount play 0.4 deg, 0.4 Hz", "it jumps by +-0.4 deg in yaw, 0.4 times a second", play(0.4, 0.4)),
      fault("mount swings at 3 Hz", "it swings by +-1 deg in yaw", sine(1.0, 3.0)),
      fault("mount swings at 7 Hz", "it swings by +-1 deg in yaw", sine(1.0, 7.0)),
      fault("mount swings at 10 Hz", "it swings by +-1 deg in yaw", sine(1.0, 10.0)),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
