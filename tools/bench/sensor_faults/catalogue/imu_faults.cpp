#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

template <class Function>
Fault imu(std::string name, std::string words, double from, Function function) {
  return {"IMU", std::move(name), std::move(words), from,
          [function] { return Changes{.imu = change<imu_t>(function)}; }};
}

/// The sensor is turned in its mount: what it measures is R times what it should.
auto turned(const Eigen::Matrix3d& R) {
  return [R](double, imu_t& m) {
    Eigen::Map<Eigen::Vector3d> acceleration(m.acceleration), rate(m.angular_rate);
    acceleration = (R * acceleration).eval();
    rate = (R * rate).eval();
  };
}

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::AngleAxisd(radians(degrees), axis).toRotationMatrix();
}

/// `part` of the vibration on an unsprung mount: 6, 6, 10 m/s^2 and .3, .3, .15 rad/s.
auto shaken(double part) {
  return [part, random = Random(1)](double, imu_t& m) mutable {
    const double acceleration[] = {6.0, 6.0, 10.0}, rate[] = {0.3, 0.3, 0.15};
    for (int axis = 0; axis < 3; ++axis) {
      m.acceleration[axis] += random.normal(part * acceleration[axis]);
      m.angular_rate[axis] += random.normal(part * rate[axis]);
    }
  };
}

void take_rate(imu_t& m, const imu_t& from) {
  std::copy(std::begin(from.angular_rate), std::end(from.angular_rate), std::begin(m.angular_rate));
}

void take_acceleration(imu_t& m, const imu_t& from) {
  std::copy(std::begin(from.acceleration), std::end(from.acceleration), std::begin(m.acceleration));
}

double& random_value(imu_t& m, Random& random) {
  const int k = random.integer(0, 5);
  return k < 3 ? m.acceleration[k] : m.angular_rate[k - 3];
}

std::vector<Fault> imu_wrongly_mounted() {
  constexpr double kFrom = kFromTheBeginning;
  return {
      imu("gyro in deg/s", "the rates are 57.3 times what they should be", kFrom,
          [](double, auto& m) {
            for (double& rate : m.angular_rate) rate /= radians(1.0);
          }),
      imu("acceleration in g", "the accelerations are 9.8 times too small", kFrom,
          [](double, auto& m) {
            for (double& acceleration : m.acceleration) acceleration /= 9.80665;
          }),
      imu("IMU turned 90 deg", "turned by 90 deg about the vertical: x is y, y is -x", kFrom,
          turned(about(Eigen::Vector3d::UnitZ(), -90))),
      imu("IMU x, y swapped", "x is y and y is x: a left-handed frame", kFrom,
          [](double, auto& m) {
            std::swap(m.acceleration[0], m.acceleration[1]);
            std::swap(m.angular_rate[0], m.angular_rate[1]);
          }),
      imu("IMU on its side", "turned by 90 deg about ahead: y is up", kFrom,
          turned(about(Eigen::Vector3d::UnitX(), 90))),
      imu("IMU upside down", "turned by 180 deg about ahead", kFrom, turned(about(Eigen::Vector3d::UnitX(), 180))),
      imu("IMU turned 10 deg", "turned by 10 deg about the vertical", kFrom,
          turned(about(Eigen::Vector3d::UnitZ(), 10))),
      imu("IMU tilted 5 deg", "tilted by 5 deg about left", kFrom, turned(about(Eigen::Vector3d::UnitY(), 5))),
      imu("yaw rate of wrong sign", "the rate about the vertical has the other sign", kFrom,
          [](double, auto& m) { m.angular_rate[2] = -m.angular_rate[2]; }),
      imu("gyro 5 % fast", "the rate about the vertical is 5 % too large", kFrom,
          [](double, auto& m) { m.angular_rate[2] *= 1.05; }),
      imu("IMU stamps late", "stamps 40 ms after the sample was taken", kFrom,
          [](double, auto& m) { m.utime += 40'000; }),
      imu("IMU at 1/10 rate", "one message in ten", kFrom, [n = 0](double, auto&) mutable { return ++n % 10 == 0; }),
      imu("every sample twice", "each other message repeats the values of the one before", kFrom,
          [last = std::optional<imu_t>()](double, auto& m) mutable {
            if (last) {
              take_rate(m, *last);
              take_acceleration(m, *last);
              last.reset();
            } else {
              last = m;
            }
          }),
  };
}

std::vector<Fault> gyro_failing() {
  return {
      imu("yaw rate 0", "the rate about the vertical is 0", kOnTheWay, [](double, auto& m) { m.angular_rate[2] = 0; }),
      imu("gyro 0", "all rates are 0", kOnTheWay, [](double, auto& m) { std::ranges::fill(m.angular_rate, 0.0); }),
      imu("gyro frozen", "all rates stay as they are", kOnTheWay,
          [first = std::optional<imu_t>()](double, auto& m) mutable {
            if (!first) first = m;
            take_rate(m, *first);
          }),
      imu("gyro clips", "the rate about the vertical ends at 0.1 rad/s", kOnTheWay,
          [](double, auto& m) { m.angular_rate[2] = std::clamp(m.angular_rate[2], -0.1, 0.1); }),
      imu("gyro leaps", "the bias about the vertical leaps by 0.1 rad/s", kOnTheWay,
          [](double, auto& m) { m.angular_rate[2] += 0.1; }),
      imu("gyro leaps far", "the bias about the vertical leaps by 1 rad/s", kOnTheWay,
          [](double, auto& m) { m.angular_rate[2] += 1.0; }),
      imu("gyro warms up", "the bias about the vertical grows by 0.0005 rad/s each second", kOnTheWay,
          [](double t, auto& m) { m.angular_rate[2] += 0.0005 * (t - kOnTheWay); }),
  };
}

std::vector<Fault> imu_failing() {
  return {
      imu("IMU silent", "no more messages", kOnTheWay, [](double, auto&) { return false; }),
      {"IMU", "IMU and wheels silent", "no more messages of either", kOnTheWay,
       [] {
         return Changes{.imu = change<imu_t>([](double, auto&) { return false; }),
                        .wheels = change<wheels_t>([](double, auto&) { return false; })};
       }},
      imu("IMU frozen", "all values stay as they are", kOnTheWay,
          [first = std::optional<imu_t>()](double, auto& m) mutable {
            if (!first) first = m;
            take_rate(m, *first);
            take_acceleration(m, *first);
          }),
      imu("IMU shakes", "vibration of an unsprung mount: 6 to 10 m/s^2, 0.3 rad/s of noise", kOnTheWay, shaken(1.0)),
      imu("IMU shakes less", "a third of that vibration", kOnTheWay, shaken(1.0 / 3)),
      imu("IMU spikes", "a value is 50 m/s^2 or 10 rad/s off in 1 of 50 messages", kOnTheWay,
          [random = Random(1)](double, auto& m) mutable {
            if (!random.chance(0.02)) return;
            const int k = random.integer(0, 5);
            const double sign = random.chance(0.5) ? 1.0 : -1.0;
            (k < 3 ? m.acceleration[k] : m.angular_rate[k - 3]) += sign * (k < 3 ? 50.0 : 10.0);
          }),
      imu("IMU NaN", "a value is NaN in 1 of 20 messages", kOnTheWay,
          [random = Random(1)](double, auto& m) mutable {
            if (random.chance(0.05)) random_value(m, random) = std::numeric_limits<double>::quiet_NaN();
          }),
      imu("IMU clock set back", "stamps jump back by 2 s, and go on from there", kOnTheWay,
          [](double, auto& m) { m.utime -= 2'000'000; }),
  };
}

}  // namespace

std::vector<Fault> imu_faults() {
  std::vector<Fault> faults = imu_wrongly_mounted();
  for (Fault& fault : gyro_failing()) faults.push_back(std::move(fault));
  for (Fault& fault : imu_failing()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace curbstone::bench::sensor_faults::catalogue
