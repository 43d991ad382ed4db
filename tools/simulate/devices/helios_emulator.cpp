#include "tools/simulate/devices/helios_emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/simulate/devices/gprmc.hpp"
#include "tools/simulate/devices/wire_fields.hpp"

namespace curbstone::simulate::devices {

namespace {

constexpr double kFiringPeriod = 55.56e-6;  // s
constexpr double kLaserPeriod32 = 1.73e-6;  // s
constexpr double kLensOffset = 0.03498;     // m
constexpr double kRangeStep = 0.0025;       // m
constexpr int kBlocks = 12;
constexpr std::size_t kPacketSize = 1248;
constexpr std::size_t kBlocksAt = 42;
constexpr std::size_t kBlockSize = 100;
constexpr std::size_t kStampAt = 20;
constexpr std::size_t kTables = 32;

// us after the firing's first shot, 16P: the lasers do not fire at even intervals.
constexpr std::array<double, 16> kTimes16 = {0,     3.15,  6.30,  9.45,  13.26, 17.08, 20.56, 23.71,
                                             26.53, 27.77, 31.49, 32.73, 36.46, 38.94, 41.42, 43.91};

// Invented, but typical angles, not those of a real device.
constexpr std::array<HeliosAngles, 16> kAngles16 = {{{14.94, -4.02},
                                                     {12.97, 3.61},
                                                     {11.03, -3.98},
                                                     {8.96, 3.58},
                                                     {7.02, -3.97},
                                                     {5.01, 3.56},
                                                     {2.98, -3.96},
                                                     {1.03, 3.55},
                                                     {-0.97, -3.95},
                                                     {-3.02, 3.55},
                                                     {-4.98, -3.95},
                                                     {-7.01, 3.56},
                                                     {-8.97, -3.96},
                                                     {-11.04, 3.57},
                                                     {-12.96, -3.97},
                                                     {-15.03, 3.59}}};

// Those stated by the recorded device.
constexpr std::array<HeliosAngles, 32> kAngles32 = {
    {{14.94, -4.05},  {13.03, 3.61},  {10.92, -4.00},  {8.90, 3.58},   {6.96, -3.97},   {5.46, 3.56},
     {3.98, -3.96},   {2.67, 3.55},   {1.33, -3.95},   {0.00, 3.55},   {-1.33, -3.95},  {-2.67, 3.55},
     {-3.96, -3.96},  {-5.23, 3.56},  {-6.63, -3.97},  {-8.01, 3.57},  {-9.94, -3.99},  {-15.97, 3.64},
     {-12.90, -4.02}, {-18.98, 3.68}, {-21.92, -4.17}, {-27.87, 3.86}, {-24.96, -4.24}, {-30.95, 3.95},
     {-33.89, -4.50}, {-37.09, 4.12}, {-39.95, -4.74}, {-43.11, 4.36}, {-46.10, -5.01}, {-49.13, 4.59},
     {-51.90, -5.30}, {-53.70, 4.78}}};

HeliosEmulatorConfig with_angles(HeliosEmulatorConfig config) {
  if (!config.angles.empty()) return config;
  if (config.lasers == 16) {
    config.angles.assign(kAngles16.begin(), kAngles16.end());
  } else {
    config.angles.assign(kAngles32.begin(), kAngles32.end());
  }
  return config;
}

std::vector<LaserMount> mounts(const HeliosEmulatorConfig& config) {
  std::vector<LaserMount> lasers;
  for (std::size_t i = 0; i < config.angles.size(); ++i) {
    const double time = config.lasers == 16 ? kTimes16[i] * 1e-6 : static_cast<double>(i) * kLaserPeriod32;
    lasers.push_back({time, config.angles[i].elevation, config.angles[i].azimuth, 0.0});
  }
  return lasers;
}

LidarTable table_of(const HeliosEmulatorConfig& config) {
  const bool large = config.lasers != 16;
  const int single = large ? kBlocks : 2 * kBlocks;
  return {large ? "helios32" : "helios16p",
          config.lasers,
          kFiringPeriod,
          config.mode == ReturnMode::kDual ? single / 2 : single,
          kPacketSize,
          kLensOffset,
          6699,
          7788,
          1'000'000};
}

std::uint8_t code_of(ReturnMode mode) {
  return mode == ReturnMode::kStrongest ? 4 : mode == ReturnMode::kLast ? 5 : 0;
}

void put_time(std::span<std::uint8_t> bytes, std::size_t at, std::int64_t utime) {
  put_big_endian(bytes, at, 6, static_cast<std::uint64_t>(utime / 1'000'000));
  put_big_endian(bytes, at + 6, 4, static_cast<std::uint64_t>(utime % 1'000'000));
}

/// Writes a sign and the magnitude in 0.01 deg.
void put_angle(std::span<std::uint8_t> bytes, std::size_t at, double angle_deg) {
  bytes[at] = angle_deg < 0 ? 1 : 0;
  put_big_endian(bytes, at + 1, 2, static_cast<std::uint64_t>(std::lround(std::abs(angle_deg) * 100)));
}

}  // namespace

HeliosEmulator::HeliosEmulator(const HeliosEmulatorConfig& config)
    : config_(with_angles(config)), table_(table_of(config_)), beams_(mounts(config_), kLensOffset, 6.0 * config.rpm) {}

std::optional<LidarEmulator::Bytes> HeliosEmulator::add_firing(std::int64_t utime, double azimuth_deg, Shots strongest,
                                                               Shots last) {
  if (firings_ == 0) begin_packet(utime);
  put_firing(azimuth_deg, strongest, last);
  if (++firings_ < table_.firings_per_packet) return std::nullopt;
  firings_ = 0;
  ++packets_;
  return packet_;
}

void HeliosEmulator::begin_packet(std::int64_t utime) {
  packet_.assign(kPacketSize, 0);
  put_big_endian(packet_, 0, 4, 0x55AA055A);
  put_big_endian(packet_, 4, 2, 1);         // protocol version
  put_big_endian(packet_, 8, 4, packets_);  // counters of the top and the bottom board
  put_big_endian(packet_, 12, 4, packets_);
  packet_[17] = 1;  // ranges in 2.5 mm
  set_time(packet_, utime);
  packet_[30] = config_.lasers == 16 ? 0x07 : 0x06;
  put_big_endian(packet_, 38, 2, 0xBC1B);  // temperature, as recorded
  put_big_endian(packet_, 1246, 2, 0x00FF);
}

void HeliosEmulator::put_firing(double azimuth_deg, Shots strongest, Shots last) {
  const bool dual = config_.mode == ReturnMode::kDual;
  const Shots single = config_.mode == ReturnMode::kLast ? last : strongest;
  if (config_.lasers == 16 && !dual) {  // a block is two firings
    if (firings_ % 2 == 0) put_block(firings_ / 2, azimuth_deg);
    put_records(firings_ / 2, firings_ % 2 * 16, single);
  } else if (config_.lasers == 16) {  // a block is one firing with both echoes
    put_block(firings_, azimuth_deg);
    put_records(firings_, 0, strongest);
    put_records(firings_, 16, last);
  } else if (!dual) {  // a block is one firing
    put_block(firings_, azimuth_deg);
    put_records(firings_, 0, single);
  } else {  // two blocks are one firing with both echoes
    for (const int half : {0, 1}) {
      put_block(2 * firings_ + half, azimuth_deg);
      put_records(2 * firings_ + half, 0, half == 0 ? strongest : last);
    }
  }
}

void HeliosEmulator::put_block(int block, double azimuth_deg) {
  const std::size_t at = kBlocksAt + static_cast<std::size_t>(block) * kBlockSize;
  put_big_endian(packet_, at, 2, 0xFFEE);
  put_big_endian(packet_, at + 2, 2, azimuth_steps(azimuth_deg));
}

void HeliosEmulator::put_records(int block, int first_record, Shots shots) {
  std::size_t at =
      kBlocksAt + static_cast<std::size_t>(block) * kBlockSize + 4 + 3 * static_cast<std::size_t>(first_record);
  for (const LidarShot& shot : shots) {
    const std::uint16_t range = range_steps(shot.range_m, kRangeStep);
    put_big_endian(packet_, at, 2, range);
    packet_[at + 2] = range != 0 ? shot.intensity : std::uint8_t{0};
    at += 3;
  }
}

void HeliosEmulator::set_time(std::span<std::uint8_t> packet, std::int64_t utime) const {
  put_time(packet, kStampAt, utime);
}

LidarEmulator::Bytes HeliosEmulator::info(std::int64_t utime) const {
  Bytes packet(kPacketSize, 0);
  constexpr std::array<std::uint8_t, 8> kMagic = {0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55};
  std::copy(kMagic.begin(), kMagic.end(), packet.begin());
  const auto rpm = static_cast<std::uint64_t>(std::lround(config_.rpm));
  put_big_endian(packet, 8, 2, rpm);
  put_big_endian(packet, 10, 4, 0xC0A801C8);  // 192.168.1.200, to
  put_big_endian(packet, 14, 4, 0xC0A80166);  // 192.168.1.102
  put_big_endian(packet, 24, 2, 6699);
  put_big_endian(packet, 26, 2, 6699);
  put_big_endian(packet, 28, 2, 7788);
  put_big_endian(packet, 30, 2, 7788);
  put_big_endian(packet, 34, 2, 36000);  // end of the field of view
  put_big_endian(packet, 40, 5, 0x0001050009);
  put_big_endian(packet, 45, 5, 0x0003072001);
  put_big_endian(packet, 292, 6, 0x2410BAC9D50B);  // serial number
  packet[300] = code_of(config_.mode);
  packet[302] = 1;  // synchronised with the GPS
  put_time(packet, 303, utime);
  put_big_endian(packet, 352, 2, rpm);  // actual speed
  packet[359] = 0x07;                   // PPS, GPRMC, UTC
  const std::string text = gprmc(utime);
  std::copy(text.begin(), text.end(), packet.begin() + 382);
  for (std::size_t i = 0; i < kTables; ++i) {
    const HeliosAngles angles = i < config_.angles.size() ? config_.angles[i] : HeliosAngles{};
    put_angle(packet, 468 + 3 * i, angles.elevation);
    put_angle(packet, 564 + 3 * i, angles.azimuth);
  }
  put_big_endian(packet, 1246, 2, 0x0FF0);
  return packet;
}

}  // namespace curbstone::simulate::devices
