#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

template <class Function>
Fault imu_with(std::string name, std::string words, double from, Function function) {
  return {"IMU", std::move(name), std::move(words), from,
          [function] { return Changes{.imu = change<imu_t>(function)}; }};
}

auto turned_by(const Eigen::Matrix3d& R) {
  return [R](double, imu_t& m) {
    Eigen::Map<Eigen::Vector3d> acceleration(m.acceleration), rate(m.angular_rate);
    acceleration = (R * acceleration).eval();
    rate = (R * rate).eval();
  };
}

/// `by` more of an axis, from then on.
auto more(double by, bool of_rate, int axis) {
  return [=](double, imu_t& m) { (of_rate ? m.angular_rate : m.acceleration)[axis] += by; };
}

}  // namespace

std::vector<Fault> imu_range_faults() {
  using Axis = Eigen::Vector3d;
  constexpr double kFrom = kFromTheBeginning;
  return {
      imu_with("IMU turned 180 deg", "turned by 180 deg about the vertical: it looks back", kFrom,
               turned_by(Eigen::AngleAxisd(radians(180), Axis::UnitZ()).toRotationMatrix())),
      imu_with("IMU on its front", "turned by 90 deg about left: x is down", kFrom,
               turned_by(Eigen::AngleAxisd(radians(90), Axis::UnitY()).toRotationMatrix())),
      imu_with("IMU tilted 20 deg", "tilted by 20 deg about ahead", kFrom,
               turned_by(Eigen::AngleAxisd(radians(20), Axis::UnitX()).toRotationMatrix())),
      imu_with("IMU shifts 8 deg", "a knock tilts it by 8 deg about left", kOnTheWay,
               turned_by(Eigen::AngleAxisd(radians(8), Axis::UnitY()).toRotationMatrix())),
      imu_with("gyro of twice the scale", "the rates are twice what they should be: another range is set", kFrom,
               [](double, auto& m) {
                 for (double& rate : m.angular_rate) rate *= 2.0;
               }),
      imu_with("accelerometer of twice the scale", "the accelerations are twice what they should be", kFrom,
               [](double, auto& m) {
                 for (double& acceleration : m.acceleration) acceleration *= 2.0;
               }),
      imu_with("acceleration without gravity", "the device takes gravity out", kFrom,
               [](double, auto& m) { m.acceleration[2] -= 9.80665; }),
      imu_with("accelerometer leaps", "the bias ahead leaps by 1 m/s^2", kOnTheWay, more(1.0, false, 0)),
      imu_with("accelerometer leaps up", "the bias upwards leaps by 2 m/s^2", kOnTheWay, more(2.0, false, 2)),
      imu_with("gyro leaps about ahead", "the bias about ahead leaps by 0.1 rad/s", kOnTheWay, more(0.1, true, 0)),
      imu_with("pot-holes", "twice a second a blow of 60 m/s^2 for 20 ms, clipped at 20 m/s^2", kOnTheWay,
               [](double t, auto& m) {
                 const double since = std::fmod(t, 0.5);
                 if (since < 0.04) m.acceleration[2] += since < 0.02 ? 60.0 : -60.0;
                 for (double& acceleration : m.acceleration) acceleration = std::clamp(acceleration, -20.0, 20.0);
               }),
      imu_with("accelerometer overflows", "beyond 10 m/s^2 upwards it goes on at -10 m/s^2", kOnTheWay,
               [](double, auto& m) {
                 if (m.acceleration[2] > 10.0) m.acceleration[2] -= 20.0;
               }),
      imu_with("gyro holds for a second", "the rates stay as they are for 1 s in each 3 s", kOnTheWay,
               [held = std::optional<imu_t>()](double t, auto& m) mutable {
                 if (std::fmod(t, 3.0) >= 1.0) {
                   held.reset();
                   return;
                 }
                 if (!held) held = m;
                 std::copy(std::begin(held->angular_rate), std::end(held->angular_rate), std::begin(m.angular_rate));
               }),
      imu_with("IMU in TAI", "stamps are 37 s ahead", kFrom, [](double, auto& m) { m.utime += 37'000'000; }),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
