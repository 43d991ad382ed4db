#include "tools/simulate/devices/rs16_emulator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

#include "drivers/lidar/models/rs16/difop_packet.hpp"
#include "tools/simulate/devices/wire_fields.hpp"

namespace curbstone::simulate::devices {

namespace {

constexpr double kRadiansADegree = std::numbers::pi / 180.0;
constexpr double kDistanceStep = 0.005;  // m

/// In dual return mode the two returns use both halves of a block.
LidarTable table_of(ReturnMode mode) {
  using namespace lidar::models::rs16;
  const int sequences = mode == ReturnMode::kDual ? kSequencesPerPacket / kSequencesPerBlock : kSequencesPerPacket;
  return {"rs16", kLasers, kSequencePeriod, sequences, lidar::models::robosense::kPacketSize, kLensOffset,
          6699,   7788,    1'000'000};
}

}  // namespace

Rs16Emulator::Rs16Emulator(const Rs16EmulatorConfig& config)
    : elevations_(config.elevations),
      rate_(config.rpm / 60.0 * 360.0),
      mode_(config.mode),
      table_(table_of(config.mode)) {
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    by_laser_[i] = {std::cos(elevations_[i] * kRadiansADegree), std::sin(elevations_[i] * kRadiansADegree)};
  }
}

std::vector<double> Rs16Emulator::elevations_deg() const {
  return {elevations_.begin(), elevations_.end()};
}

void Rs16Emulator::beams(double azimuth_deg, std::span<LidarRay> by_laser) const {
  std::ranges::copy(rays(azimuth_deg), by_laser.begin());
}

std::optional<LidarEmulator::Bytes> Rs16Emulator::add_firing(std::int64_t utime, double azimuth_deg, Shots strongest,
                                                             Shots last) {
  constexpr std::size_t kLasers = lidar::models::rs16::kLasers;
  const auto packet =
      mode_ == ReturnMode::kDual
          ? add_dual(utime, azimuth_deg, strongest.first<kLasers>(), last.first<kLasers>())
          : add_sequence(utime, azimuth_deg, (mode_ == ReturnMode::kLast ? last : strongest).first<kLasers>());
  if (!packet) return std::nullopt;
  return Bytes(packet->begin(), packet->end());
}

void Rs16Emulator::set_time(std::span<std::uint8_t> packet, std::int64_t utime) const {
  const lidar::models::robosense::PacketTime time = lidar::models::robosense::packet_time_from(utime);
  std::memcpy(packet.data() + offsetof(lidar::models::rs16::MsopPacket, time), &time, sizeof time);
}

LidarEmulator::Bytes Rs16Emulator::info(std::int64_t utime) const {
  const lidar::models::rs16::Rs16Packet packet = difop(utime, static_cast<int>(std::lround(rate_ / 6.0)));
  return {packet.begin(), packet.end()};
}

std::array<LidarRay, lidar::models::rs16::kLasers> Rs16Emulator::rays(double azimuth_deg) const {
  std::array<LidarRay, lidar::models::rs16::kLasers> rays;
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    rays[i].time_offset = static_cast<double>(i) * lidar::models::rs16::kLaserPeriod;
    const double azimuth = (azimuth_deg + rate_ * rays[i].time_offset) * kRadiansADegree;
    const Eigen::Vector3d outward(std::cos(azimuth), -std::sin(azimuth), 0.0);
    rays[i].origin = lidar::models::rs16::kLensOffset * outward;
    rays[i].direction = by_laser_[i].cos * outward + by_laser_[i].sin * Eigen::Vector3d::UnitZ();
  }
  return rays;
}

void Rs16Emulator::begin_packet(std::int64_t utime) {
  packet_ = lidar::models::rs16::MsopPacket{};
  packet_.magic = lidar::models::robosense::kMsopMagic;
  packet_.time = lidar::models::robosense::packet_time_from(utime);
  packet_.tail = {0x00, 0xFF};
}

void Rs16Emulator::put(std::size_t block, std::size_t half, Laser16 by_laser) {
  lidar::models::rs16::MsopRecord* records = packet_.blocks[block].records + half * lidar::models::rs16::kLasers;
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    records[i].distance = range_steps(by_laser[i].range_m, kDistanceStep);
    records[i].intensity = records[i].distance != 0 ? by_laser[i].intensity : std::uint8_t{0};
  }
}

std::optional<lidar::models::rs16::Rs16Packet> Rs16Emulator::add_sequence(
    std::int64_t utime, double azimuth_deg, std::span<const LidarShot, lidar::models::rs16::kLasers> by_laser) {
  if (sequences_ == 0) begin_packet(utime);
  const auto block = static_cast<std::size_t>(sequences_ / lidar::models::rs16::kSequencesPerBlock);
  const auto half = static_cast<std::size_t>(sequences_ % lidar::models::rs16::kSequencesPerBlock);
  if (half == 0) {
    packet_.blocks[block].flag = lidar::models::rs16::MsopBlock::kFlag;
    packet_.blocks[block].azimuth = azimuth_steps(azimuth_deg);
  }
  put(block, half, by_laser);
  if (++sequences_ < lidar::models::rs16::kSequencesPerPacket) return std::nullopt;
  sequences_ = 0;
  return std::bit_cast<lidar::models::rs16::Rs16Packet>(packet_);
}

std::optional<lidar::models::rs16::Rs16Packet> Rs16Emulator::add_dual(std::int64_t utime, double azimuth_deg,
                                                                      Laser16 strongest, Laser16 last) {
  if (sequences_ == 0) begin_packet(utime);
  const auto block = static_cast<std::size_t>(sequences_);
  packet_.blocks[block].flag = lidar::models::rs16::MsopBlock::kFlag;
  packet_.blocks[block].azimuth = azimuth_steps(azimuth_deg);
  put(block, 0, strongest);
  put(block, 1, last);
  if (++sequences_ < static_cast<int>(std::size(packet_.blocks))) return std::nullopt;
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
  packet.return_mode = mode_ == ReturnMode::kDual ? 0 : mode_ == ReturnMode::kStrongest ? 1 : 2;
  packet.time = lidar::models::robosense::packet_time_from(utime);
  for (std::size_t i = 0; i < lidar::models::rs16::kLasers; ++i) {
    packet.elevation[i] = static_cast<std::uint32_t>(std::lround(std::abs(elevations_[i]) * 1e4));
  }
  packet.tail = {0x0F, 0xF0};
  return std::bit_cast<lidar::models::rs16::Rs16Packet>(packet);
}

}  // namespace curbstone::simulate::devices
