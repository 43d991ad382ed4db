#include "tools/simulate/devices/vlp16_emulator.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tools/simulate/devices/gprmc.hpp"
#include "tools/simulate/devices/wire_fields.hpp"

namespace curbstone::simulate::devices {

namespace {

constexpr int kLasers = 16;
constexpr double kLaserPeriod = 2.304e-6;    // s
constexpr double kFiringPeriod = 55.296e-6;  // s
constexpr double kRangeStep = 0.002;         // m
constexpr std::size_t kPacketSize = 1206;
constexpr std::size_t kBlockSize = 100;
constexpr std::size_t kStampAt = 1200;
constexpr std::size_t kModeAt = 1204;
constexpr std::size_t kProductAt = 1205;
constexpr std::uint8_t kVlp16 = 0x22;
constexpr std::int64_t kHour = 3'600'000'000;  // us

constexpr std::size_t kPositionSize = 512;
constexpr std::size_t kPositionStampAt = 198;
constexpr std::size_t kPpsAt = 202;
constexpr std::uint8_t kPpsLocked = 2;
constexpr std::size_t kTextAt = 206;

// By laser in firing order: deg above the horizon, mm of the lens above the centre. Manual, table 9-1.
constexpr std::array<std::pair<int, double>, kLasers> kMounts = {{{-15, 11.2},
                                                                  {1, -0.7},
                                                                  {-13, 9.7},
                                                                  {3, -2.2},
                                                                  {-11, 8.1},
                                                                  {5, -3.7},
                                                                  {-9, 6.6},
                                                                  {7, -5.1},
                                                                  {-7, 5.1},
                                                                  {9, -6.6},
                                                                  {-5, 3.7},
                                                                  {11, -8.1},
                                                                  {-3, 2.2},
                                                                  {13, -9.7},
                                                                  {-1, 0.7},
                                                                  {15, -11.2}}};

std::vector<LaserMount> mounts() {
  std::vector<LaserMount> lasers;
  for (const auto& [elevation, height] : kMounts)
    lasers.push_back(
        {static_cast<double>(lasers.size()) * kLaserPeriod, static_cast<double>(elevation), 0.0, height * 1e-3});
  return lasers;
}

LidarTable table_of(ReturnMode mode) {
  const int firings = mode == ReturnMode::kDual ? 12 : 24;
  // One position packet per 14 point packets.
  const auto period = static_cast<std::int64_t>(14 * firings * kFiringPeriod * 1e6);
  return {"vlp16", kLasers, kFiringPeriod, firings, kPacketSize, 0.0, 2368, 8308, period};
}

std::uint8_t code_of(ReturnMode mode) {
  return mode == ReturnMode::kStrongest ? 0x37 : mode == ReturnMode::kLast ? 0x38 : 0x39;
}

}  // namespace

Vlp16Emulator::Vlp16Emulator(const Vlp16EmulatorConfig& config)
    : mode_(config.mode), table_(table_of(config.mode)), beams_(mounts(), 0.0, 6.0 * config.rpm) {}

std::optional<LidarEmulator::Bytes> Vlp16Emulator::add_firing(std::int64_t utime, double azimuth_deg, Shots strongest,
                                                              Shots last) {
  if (firings_ == 0) begin_packet(utime);
  const int block = firings_ / 2, half = firings_ % 2;
  if (mode_ == ReturnMode::kDual) {
    put_records(2 * block, half, azimuth_deg, last);
    put_records(2 * block + 1, half, azimuth_deg, strongest);
  } else {
    put_records(block, half, azimuth_deg, mode_ == ReturnMode::kLast ? last : strongest);
  }
  if (++firings_ < table_.firings_per_packet) return std::nullopt;
  firings_ = 0;
  return packet_;
}

void Vlp16Emulator::begin_packet(std::int64_t utime) {
  packet_.assign(kPacketSize, 0);
  set_time(packet_, utime);
  packet_[kModeAt] = code_of(mode_);
  packet_[kProductAt] = kVlp16;
}

void Vlp16Emulator::put_records(int block, int half, double azimuth_deg, Shots shots) {
  const auto begin = static_cast<std::size_t>(block) * kBlockSize;
  if (half == 0) {
    put_big_endian(packet_, begin, 2, 0xFFEE);
    put_little_endian(packet_, begin + 2, 2, azimuth_steps(azimuth_deg));
  }
  for (std::size_t i = 0; i < kLasers; ++i) {
    const std::size_t at = begin + 4 + 3 * (static_cast<std::size_t>(half) * kLasers + i);
    const std::uint16_t range = range_steps(shots[i].range_m, kRangeStep);
    put_little_endian(packet_, at, 2, range);
    packet_[at + 2] = range != 0 ? shots[i].intensity : std::uint8_t{0};
  }
}

void Vlp16Emulator::set_time(std::span<std::uint8_t> packet, std::int64_t utime) const {
  put_little_endian(packet, kStampAt, 4, static_cast<std::uint64_t>(utime % kHour));
}

LidarEmulator::Bytes Vlp16Emulator::info(std::int64_t utime) const {
  Bytes packet(kPositionSize, 0);
  put_little_endian(packet, kPositionStampAt, 4, static_cast<std::uint64_t>(utime % kHour));
  packet[kPpsAt] = kPpsLocked;
  const std::string text = gprmc(utime);
  std::copy(text.begin(), text.end(), packet.begin() + static_cast<std::ptrdiff_t>(kTextAt));
  return packet;
}

}  // namespace curbstone::simulate::devices
