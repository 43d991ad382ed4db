#include "tests/services/ekf/real_robot_drive.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <span>

#include "common/bytes/big_endian.hpp"
#include "common/log/log_reader.hpp"
#include "tests/paths.hpp"

namespace curbstone::ekf {

namespace {

constexpr double kTicks = 480;  // a turn of a wheel

double number(std::span<const std::uint8_t> bytes) {
  return std::bit_cast<double>(read_big_endian<std::uint64_t>(bytes));
}

}  // namespace

std::optional<Drive> real_robot_drive(VehicleConfig& vehicle) {
  const std::string path = tests::data_path("lcm/botlab_convex.lcmlog");
  if (!std::filesystem::exists(path)) return std::nullopt;
  vehicle.wheel_radius = 0.016;
  vehicle.track_width = 0.205;  // with which the wheels turn as the gyro does
  vehicle.imu = {0, 0, 0.03, 0, 0, 0};
  Drive drive;
  std::vector<std::int64_t> delays;
  LogReader log(path);
  while (const auto event = log.next()) {
    const std::span<const std::uint8_t> bytes(event->bytes.data(), event->bytes.size());
    if (bytes.size() < 24) continue;
    if (event->channel == "MAEBOT_IMU" && bytes.size() >= 64) {
      base::ImuSample sample;
      sample.utime = event->log_utime;
      for (int k = 0; k < 3; ++k) {
        sample.acceleration[k] = number(bytes.subspan(16 + 8 * static_cast<std::size_t>(k))) / 16384 * 9.80665;
        sample.angular_rate[k] = number(bytes.subspan(40 + 8 * static_cast<std::size_t>(k))) / 131 * M_PI / 180;
      }
      drive.imu.push_back(sample);
    } else if (event->channel == "MAEBOT_ENCODERS") {
      const auto ticks = [&](std::size_t at) {
        return static_cast<std::int32_t>(read_big_endian<std::uint32_t>(bytes.subspan(at)));
      };
      const auto utime = static_cast<std::int64_t>(read_big_endian<std::uint64_t>(bytes.subspan(8)));
      delays.push_back(event->log_utime - utime);
      drive.wheels.push_back({utime, {2 * M_PI * ticks(16) / kTicks, 2 * M_PI * ticks(20) / kTicks}});
    }
  }
  std::nth_element(delays.begin(), delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2), delays.end());
  for (base::WheelSample& sample : drive.wheels) sample.utime += delays[delays.size() / 2];
  return drive;
}

}  // namespace curbstone::ekf
