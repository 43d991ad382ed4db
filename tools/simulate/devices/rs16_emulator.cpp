#include "tools/simulate/devices/rs16_emulator.hpp"

#include <bit>
#include <cmath>
#include <numbers>

#include "drivers/lidar/models/rs16/difop_packet.hpp"

namespace curbstone::simulate::devices {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDistanceStep = 0.005;  // m

std::uint16_t encode_distance(float range_m) {
  const double steps = std::round(static_cast<double>(range_m) / kDistanceStep);
  return steps > 0 && steps <= 65535 ? static_cast<std::uint16_t>(steps) : std::uint16_t{0};
}

std::uint16_t encode_azimuth(double azimuth_deg) {
  const double turns = azimuth_deg / 360.0;
  const auto steps = static_cast<int>(std::lround((turns - std::floor(turns)) * 36000.0));
  return static_cast<std::uint16_t>(steps % 36000);
}

}  // namespace

Rs16Emulator::Rs16Emulator(const Rs16EmulatorConfig& config)
    : elevations_(config.elevations), rate_(config.rpm / 60.0 * 360.0) {
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    by_laser_[i] = {std::cos(elevations_[i] * kDegree), std::sin(elevations_[i] * kDegree)};
  }
}

std::array<Rs16Ray, lidar::models::rs16::kLasers> Rs16Emulator::rays(double azimuth_deg) const {
  std::array<Rs16Ray, lidar::models::rs16::kLasers> rays;
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    rays[i].time_offset = static_cast<double>(i) * lidar::models::rs16::kLaserPeriod;
    const double azimuth = (azimuth_deg + rate_ * rays[i].time_offset) * kDegree;
    const Eigen::Vector3d outward(std::cos(azimuth), -std::sin(azimuth), 0.0);
    rays[i].origin = lidar::models::rs16::kLensOffset * outward;
    rays[i].direction = by_laser_[i].cos * outward + by_laser_[i].sin * Eigen::Vector3d::UnitZ();
  }
  return rays;
}

std::optional<lidar::models::rs16::Rs16Packet> Rs16Emulator::add_sequence(
    std::int64_t utime, double azimuth_deg, std::span<const Rs16Shot, lidar::models::rs16::kLasers> by_laser) {
  if (sequences_ == 0) {
    packet_ = lidar::models::rs16::MsopPacket{};
    packet_.magic = lidar::models::robosense::kMsopMagic;
    packet_.time = lidar::models::robosense::packet_time_from(utime);
    packet_.tail = {0x00, 0xFF};
  }
  lidar::models::rs16::MsopBlock& block = packet_.blocks[sequences_ / lidar::models::rs16::kSequencesPerBlock];
  const int half = sequences_ % lidar::models::rs16::kSequencesPerBlock;
  if (half == 0) {
    block.flag = lidar::models::rs16::MsopBlock::kFlag;
    block.azimuth = encode_azimuth(azimuth_deg);
  }
  lidar::models::rs16::MsopRecord* records = block.records + half * lidar::models::rs16::kLasers;
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    records[i].distance = encode_distance(by_laser[i].range_m);
    records[i].intensity = records[i].distance != 0 ? by_laser[i].intensity : std::uint8_t{0};
  }
  if (++sequences_ < lidar::models::rs16::kSequencesPerPacket) return std::nullopt;
  sequences_ = 0;
  return std::bit_cast<lidar::models::rs16::Rs16Packet>(packet_);
}

lidar::models::rs16::Rs16Packet Rs16Emulator::difop(std::int64_t utime, int rpm) const {
  lidar::models::rs16::DifopPacket packet{};
  packet.magic = lidar::models::robosense::kDifopMagic;
  packet.rpm = static_cast<std::uint16_t>(rpm);
  packet.fov_end = 36000;
  packet.firmware = {0x06, 0x23, 0x06, 0x06, 0xA0};
  packet.bottom_firmware = {0x09, 0x00, 0x0C, 0x02, 0xA0};
  packet.return_mode = 1;
  packet.time = lidar::models::robosense::packet_time_from(utime);
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    packet.elevation[i] = static_cast<std::uint32_t>(std::lround(std::abs(elevations_[i]) * 1e4));
  }
  packet.tail = {0x0F, 0xF0};
  return std::bit_cast<lidar::models::rs16::Rs16Packet>(packet);
}

}  // namespace curbstone::simulate::devices
