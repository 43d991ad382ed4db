#include "tools/simulate/devices/wit_emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/bytes/little_endian.hpp"
#include "common/geometry/gravity.hpp"
#include "drivers/imu/witmotion/wit_frame.hpp"

namespace curbstone::simulate::devices {

namespace {

constexpr std::array<int, 12> kHz = {0, 0, 0, 1, 2, 5, 10, 20, 50, 100, 0, 200};  // by the code in register 03

std::vector<std::uint8_t> frame(std::uint8_t id, std::array<double, 4> words) {
  std::array<std::uint8_t, 8> data{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto word = static_cast<std::int16_t>(std::lround(std::clamp(words[i], -32768.0, 32767.0)));
    write_little_endian(std::span(data).subspan(2 * i), static_cast<std::uint16_t>(word));
  }
  return imu::witmotion::encode_wit(id, data);
}

}  // namespace

void WitEmulator::power_on(std::int64_t now) {
  *this = {};
  powered_ = now;
}

void WitEmulator::on_bytes(std::span<const std::uint8_t> bytes) {
  received_.insert(received_.end(), bytes.begin(), bytes.end());
  std::span<const std::uint8_t> rest = received_;
  while (rest.size() >= 5) {
    if (rest[0] != 0xFF || rest[1] != 0xAA) {
      rest = rest.subspan(1);
      continue;
    }
    on_command(rest[2], read_little_endian<std::uint16_t>(rest.subspan(3)));
    rest = rest.subspan(5);
  }
  received_.erase(received_.begin(), received_.end() - static_cast<std::ptrdiff_t>(rest.size()));
}

void WitEmulator::on_command(std::uint8_t reg, std::uint16_t value) {
  if (reg == 0x69) unlocked_ = value == 0xB588;
  if (!unlocked_) return;
  if (reg == 0x02) frames_ = value;
  if (reg == 0x03 && value < kHz.size() && kHz[value] > 0) rate_ = static_cast<std::uint8_t>(value);
}

std::int64_t WitEmulator::period() const {
  return 1'000'000 / kHz[rate_];
}

std::vector<std::uint8_t> WitEmulator::sample(std::int64_t now, const XsensSample& sample) {
  std::vector<std::uint8_t> bytes;
  const auto send = [&](int bit, const std::vector<std::uint8_t>& frame) {
    if ((frames_ >> bit & 1) != 0) bytes.insert(bytes.end(), frame.begin(), frame.end());
  };
  const std::int64_t ms = (now - powered_) / 1000 % 86'400'000;
  std::array<std::uint8_t, 8> time = {15, 1, 1};  // 2015-01-01
  time[3] = static_cast<std::uint8_t>(ms / 3'600'000);
  time[4] = static_cast<std::uint8_t>(ms / 60'000 % 60);
  time[5] = static_cast<std::uint8_t>(ms / 1000 % 60);
  write_little_endian(std::span(time).subspan(6), static_cast<std::uint16_t>(ms % 1000));
  const double g = 32768 / (16 * kGravity), rate = 32768 / (2000 * std::numbers::pi / 180);
  const auto& a = sample.acceleration;
  const auto& w = sample.angular_rate;
  const double temperature = sample.temperature * 100;
  send(0, imu::witmotion::encode_wit(0x50, time));
  send(1, frame(0x51, {a[0] * g, a[1] * g, a[2] * g, temperature}));
  send(2, frame(0x52, {w[0] * rate, w[1] * rate, w[2] * rate, temperature}));
  send(3, frame(0x53, {0, 0, 0, temperature}));
  send(4, frame(0x54, {100, 200, -300, temperature}));
  if (const auto& q = sample.orientation) {
    send(9, frame(0x59, {(*q)[0] * 32768, (*q)[1] * 32768, (*q)[2] * 32768, (*q)[3] * 32768}));
  }
  return bytes;
}

}  // namespace curbstone::simulate::devices
