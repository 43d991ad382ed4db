#include "tools/simulate/devices/xsens_emulator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/bytes/big_endian.hpp"

namespace curbstone::simulate::devices {

namespace {

constexpr std::int64_t kBootTime = 500'000;  // us within which WakeUpAck must arrive
constexpr std::uint16_t kUnrated = 0xFFFF;   // outputs without a rate, sent with every message

void append_floats(std::vector<std::uint8_t>& payload, std::span<const double> values) {
  for (const double value : values) append_big_endian(payload, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

bool has_rate(std::uint16_t id) {
  return id != 0x1020 && id != 0x1060 && id != 0xE020;
}

}  // namespace

std::vector<std::uint8_t> XsensEmulator::power_on(std::int64_t now) {
  state_ = State::kBooting;
  powered_ = now;
  counter_ = 0;
  parser_.reset();
  if (outputs_.empty()) use_default_outputs();
  return imu::xsens::encode_xbus(imu::xsens::Mid::kWakeUp);
}

void XsensEmulator::use_default_outputs() {
  rate_ = settings_.rate;
  const auto rate = static_cast<std::uint16_t>(rate_);
  outputs_ = {{0x1020, kUnrated}, {0x1060, kUnrated}};
  if (!settings_.configured) return;
  outputs_.insert(outputs_.end(), {{0x2010, rate}, {0x4020, rate}, {0x8020, rate}, {0xE020, kUnrated}});
}

bool XsensEmulator::measuring(std::int64_t now) const {
  return state_ == State::kMeasurement || (state_ == State::kBooting && now - powered_ >= kBootTime);
}

std::vector<std::uint8_t> XsensEmulator::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> answer;
  if (state_ == State::kOff) return answer;
  if (measuring(now)) state_ = State::kMeasurement;
  parser_.parse(now, bytes, [&](const imu::xsens::XbusFrame& frame) { on_frame(frame, now, answer); });
  return answer;
}

void XsensEmulator::on_frame(const imu::xsens::XbusFrame& frame, std::int64_t now, std::vector<std::uint8_t>& answer) {
  const auto reply = [&](const std::vector<std::uint8_t>& bytes) {
    answer.insert(answer.end(), bytes.begin(), bytes.end());
  };
  const auto refuse = [&](std::uint8_t code) {
    reply(imu::xsens::encode_xbus(imu::xsens::Mid::kError, std::span(&code, 1)));
  };
  if (frame.is(imu::xsens::Mid::kWakeUpAck)) {
    if (state_ == State::kBooting) state_ = State::kConfig;
  } else if (frame.is(imu::xsens::Mid::kGotoConfig)) {
    state_ = State::kConfig;
    reply(imu::xsens::encode_xbus(imu::xsens::Mid::kGotoConfigAck));
  } else if (frame.is(imu::xsens::Mid::kReset)) {
    reply(imu::xsens::encode_xbus(imu::xsens::Mid::kResetAck));
    reply(power_on(now));
  } else if (state_ != State::kConfig) {
    refuse(0x04);  // invalid message in this state
  } else if (frame.is(imu::xsens::Mid::kGotoMeasurement)) {
    state_ = State::kMeasurement;
    reply(imu::xsens::encode_xbus(imu::xsens::Mid::kGotoMeasurementAck));
  } else if (frame.is(imu::xsens::Mid::kSetOutputConfiguration)) {
    if (frame.data.size() % 4 != 0 || frame.data.size() > 128) return refuse(0x21);
    reply(imu::xsens::encode_xbus(imu::xsens::Mid::kOutputConfiguration, configure(frame.data)));
  } else {
    refuse(0x04);
  }
}

/// Responds with the effective settings: FFFF for outputs without a rate, other rates limited to what the device
/// supports.
std::vector<std::uint8_t> XsensEmulator::configure(std::span<const std::uint8_t> list) {
  std::vector<std::uint8_t> effective;
  outputs_.clear();
  for (; list.size() >= 4; list = list.subspan(4)) {
    Output output{read_big_endian<std::uint16_t>(list), read_big_endian<std::uint16_t>(list.subspan(2))};
    if (has_rate(output.id)) {
      output.rate = std::clamp<std::uint16_t>(output.rate, 1, 400);
      rate_ = output.rate;
    } else {
      output.rate = kUnrated;
    }
    outputs_.push_back(output);
    append_big_endian(effective, output.id);
    append_big_endian(effective, output.rate);
  }
  return effective;
}

std::vector<std::uint8_t> XsensEmulator::sample(std::int64_t now, const XsensSample& sample) {
  if (!measuring(now)) return {};
  state_ = State::kMeasurement;
  std::vector<std::uint8_t> payload;
  for (const Output& output : outputs_) append_item(payload, output.id, now, sample);
  ++counter_;
  return imu::xsens::encode_xbus(imu::xsens::Mid::kMtData2, payload);
}

void XsensEmulator::append_item(std::vector<std::uint8_t>& payload, std::uint16_t id, std::int64_t now,
                                const XsensSample& sample) {
  const auto header = [&](std::uint8_t size) {
    append_big_endian(payload, id);
    payload.push_back(size);
  };
  switch (id & 0xF8F0) {
    case 0x1020:
      header(2);
      append_big_endian(payload, counter_);
      break;
    case 0x1060: {
      const double elapsed = static_cast<double>(now - powered_) * (1.0 + settings_.clock_error);
      const auto ticks = settings_.first_tick + static_cast<std::uint64_t>(std::llround(elapsed / 100.0));
      header(4);
      append_big_endian(payload,
                        static_cast<std::uint32_t>(settings_.tick_wrap == 0 ? ticks : ticks % settings_.tick_wrap));
      break;
    }
    case 0x0810:
      header(4);
      append_floats(payload, std::span(&sample.temperature, 1));
      break;
    case 0x2010:
      if (!sample.orientation) break;
      header(16);
      append_floats(payload, *sample.orientation);
      break;
    case 0x4020:
      header(12);
      append_floats(payload, sample.acceleration);
      break;
    case 0x8020:
      header(12);
      append_floats(payload, sample.angular_rate);
      break;
    case 0xE020:
      header(4);
      append_big_endian(payload, std::uint32_t{0x3} | sample.clipping);
      break;
    default:
      break;  // not measured by this device
  }
}

}  // namespace curbstone::simulate::devices
