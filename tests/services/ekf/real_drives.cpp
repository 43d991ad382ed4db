#include "tests/services/ekf/real_drives.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>

#include "common/bytes/big_endian.hpp"
#include "common/bytes/little_endian.hpp"
#include "common/geometry/geometry.hpp"
#include "common/log/log_reader.hpp"
#include "drivers/encoder/traces/trace_file.hpp"
#include "tests/paths.hpp"

namespace curbstone::ekf {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr double kOneDegree = std::numbers::pi / 180;
constexpr double kGravityOfUnits = 9.80665;  // m/s^2

namespace robot {

constexpr double kTicks = 480;  // a turn of a wheel

double number(Bytes bytes) {
  return std::bit_cast<double>(read_big_endian<std::uint64_t>(bytes));
}

RealDrive read(const std::string& path, bool stamped_by_the_log) {
  RealDrive out;
  out.vehicle.wheel_radius = 0.016;
  out.vehicle.track_width = 0.205;  // with which the wheels turn as the gyro does
  out.vehicle.imu = {0, 0, 0.03, 0, 0, 0};
  std::vector<std::int64_t> delays;
  LogReader log(path);
  while (const auto event = log.next()) {
    const Bytes bytes(event->bytes.data(), event->bytes.size());
    if (bytes.size() < 24) continue;
    if (event->channel == "MAEBOT_IMU" && bytes.size() >= 64) {
      base::ImuSample sample;
      sample.utime = event->log_utime;
      for (int k = 0; k < 3; ++k) {
        const auto at = 8 * static_cast<std::size_t>(k);
        sample.acceleration[k] = number(bytes.subspan(16 + at)) / 16384 * kGravityOfUnits;
        sample.angular_rate[k] = number(bytes.subspan(40 + at)) / 131 * kOneDegree;
      }
      out.drive.imu.push_back(sample);
    } else if (event->channel == "MAEBOT_ENCODERS") {
      const auto angle = [&](std::size_t at) {
        const auto ticks = static_cast<std::int32_t>(read_big_endian<std::uint32_t>(bytes.subspan(at)));
        return 2 * std::numbers::pi * ticks / kTicks;
      };
      const auto utime = static_cast<std::int64_t>(read_big_endian<std::uint64_t>(bytes.subspan(8)));
      delays.push_back(event->log_utime - utime);
      out.drive.wheels.push_back({stamped_by_the_log ? event->log_utime : utime, {angle(16), angle(20)}});
    }
  }
  if (stamped_by_the_log) return out;
  const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
  std::nth_element(delays.begin(), middle, delays.end());
  for (base::WheelSample& sample : out.drive.wheels) sample.utime += *middle;
  return out;
}

}  // namespace robot

namespace race_car {

constexpr std::uint32_t kLeftMotor = 0x181, kRightMotor = 0x182, kGyro = 0x4EC, kAccelerometer = 0x4ED;
constexpr std::uint8_t kSpeedRegister = 0xA8;
constexpr double kSpeedUnit = 1.22e-3;         // m/s
constexpr double kRateUnit = kOneDegree / 80;  // rad/s
constexpr double kForceUnit = 0.01 * kGravityOfUnits;

struct MotorSpeed {
  std::int64_t utime = 0;
  double speed = 0.0;  // m/s
};

double big(Bytes bytes, std::size_t at) {
  return static_cast<std::int16_t>(read_big_endian<std::uint16_t>(bytes.subspan(at)));
}

/// Its angles are its speeds' sums. The right one's are taken at the left one's stamps.
std::vector<base::WheelSample> wheels_of(const std::array<std::vector<MotorSpeed>, 2>& motors, double radius) {
  std::vector<base::WheelSample> out;
  std::array<double, 2> angle{};
  std::array<double, 2> last{};
  const std::vector<MotorSpeed>& right = motors[1];
  std::size_t k = 0;
  for (const MotorSpeed& left : motors[0]) {
    while (k + 1 < right.size() && right[k + 1].utime <= left.utime) ++k;
    if (k + 1 >= right.size() || right[k].utime > left.utime) continue;
    const double share =
        base::seconds_between(right[k].utime, left.utime) / base::seconds_between(right[k].utime, right[k + 1].utime);
    const std::array<double, 2> now = {left.speed, std::lerp(right[k].speed, right[k + 1].speed, share)};
    for (std::size_t i = 0; i < 2 && !out.empty(); ++i)
      angle[i] += 0.5 * (last[i] + now[i]) * base::seconds_between(out.back().utime, left.utime) / radius;
    out.push_back({left.utime, angle});
    last = now;
  }
  return out;
}

RealDrive read(const std::string& path) {
  RealDrive out;
  out.vehicle.wheel_radius = 0.25;
  out.vehicle.track_width = 1.13;
  out.vehicle.imu = {0.8, 0, 0.2, 0, 0, 0};
  std::array<std::vector<MotorSpeed>, 2> motors;
  std::optional<Eigen::Vector3d> force;
  encoder::traces::TraceFile file(path);
  while (const auto frame = file.next()) {
    const Bytes bytes = frame->frame.bytes();
    const std::uint32_t id = frame->frame.id;
    if (id == kAccelerometer && bytes.size() >= 6) {  // right, forward, down
      force = kForceUnit * Eigen::Vector3d(-big(bytes, 2), big(bytes, 0), -big(bytes, 4));
    } else if (id == kGyro && bytes.size() >= 6 && force) {
      out.drive.imu.push_back(
          {frame->utime, kRateUnit * Eigen::Vector3d(big(bytes, 2), -big(bytes, 0), big(bytes, 4)), *force});
    } else if ((id == kLeftMotor || id == kRightMotor) && bytes.size() >= 3 && bytes[0] == kSpeedRegister) {
      const auto units = static_cast<std::int16_t>(read_little_endian<std::uint16_t>(bytes.subspan(1)));
      const double sign = id == kLeftMotor ? 1 : -1;
      motors[id - kLeftMotor].push_back({frame->utime, sign * kSpeedUnit * units});
    }
  }
  out.drive.wheels = wheels_of(motors, out.vehicle.wheel_radius);
  return out;
}

}  // namespace race_car

}  // namespace

const std::vector<std::string>& real_drive_names() {
  static const std::vector<std::string> names = {"robot", "robot_by_the_log", "race_car"};
  return names;
}

std::optional<RealDrive> real_drive(const std::string& name) {
  const bool car = name == "race_car";
  const std::string path = test::data_path(car ? "can/fsae_candump.log" : "lcm/botlab_convex.lcmlog");
  if (!std::filesystem::exists(path)) return std::nullopt;
  return car ? race_car::read(path) : robot::read(path, name == "robot_by_the_log");
}

}  // namespace curbstone::ekf
