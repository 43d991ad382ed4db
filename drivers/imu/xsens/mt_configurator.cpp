#include "drivers/imu/xsens/mt_configurator.hpp"

#include <fmt/format.h>

#include <array>

#include "common/bytes/big_endian.hpp"

namespace curbstone::imu::xsens {

namespace {

constexpr std::int64_t kAnswerTime = 500'000;  // us
constexpr int kMaxTries = 4;                   // of one command, before the set-up restarts
constexpr std::uint16_t kUnrated = 0xFFFF;     // "with every message"
constexpr std::uint16_t kOutputTypeMask = 0xF8F0;

const char* error_text(std::uint8_t code) {
  switch (code) {
    case 0x03:
      return "invalid period";
    case 0x04:
      return "invalid message";
    case 0x1E:
      return "timer overflow";
    case 0x20:
      return "baud rate";
    case 0x21:
      return "invalid parameter";
    case 0x28:
      return "device error";
    case 0x29:
      return "overflow: the line is too slow for these outputs";
    case 0x2A:
      return "buffer overflow";
    default:
      return "unknown error";
  }
}

}  // namespace

std::vector<std::uint8_t> output_configuration(int rate, bool orientation) {
  const auto hz = static_cast<std::uint16_t>(rate);
  std::vector<std::uint8_t> list;
  const auto add = [&](std::uint16_t id, std::uint16_t frequency) {
    append_big_endian(list, id);
    append_big_endian(list, frequency);
  };
  add(0x1020, kUnrated);
  add(0x1060, kUnrated);
  if (orientation) add(0x2010, hz);
  add(0x4020, hz);
  add(0x8020, hz);
  add(0xE020, kUnrated);
  return list;
}

void MtConfigurator::start(std::int64_t now) {
  started_ = true;
  unanswered_ = 0;
  if (settings_.enabled) {
    enter(Step::kGotoConfig, now);
  } else {
    step_ = Step::kMeasuring;
  }
}

void MtConfigurator::enter(Step step, std::int64_t now) {
  step_ = step;
  tries_ = 0;
  if (step == Step::kMeasuring) {
    silence_.heard();
  } else {
    send_command(now);
  }
}

void MtConfigurator::send_command(std::int64_t now) {
  std::vector<std::uint8_t> bytes;
  switch (step_) {
    case Step::kGotoConfig:
      bytes = encode_xbus(Mid::kGotoConfig);
      break;
    case Step::kSetOutputs:
      bytes = encode_xbus(Mid::kSetOutputConfiguration, output_configuration(settings_.rate, settings_.orientation));
      break;
    case Step::kGotoMeasurement:
      bytes = encode_xbus(Mid::kGotoMeasurement);
      break;
    case Step::kMeasuring:
      return;
  }
  ++tries_;
  ++unanswered_;
  sent_ = now;
  counters_.add("device.commands");
  send_(bytes);
}

void MtConfigurator::on_frame(std::int64_t now, const XbusFrame& frame) {
  if (!started_) start(now);
  if (frame.is(Mid::kError)) return on_error(now, frame.data);
  if (!settings_.enabled) return;
  if (frame.is(Mid::kWakeUp)) {  // answered within 0.5 s, or it starts to measure with its stored configuration
    counters_.add("device.restarts");
    send_(encode_xbus(Mid::kWakeUpAck));
    enter(Step::kGotoConfig, now);
  } else if (step_ == Step::kGotoConfig && frame.is(Mid::kGotoConfigAck)) {
    unanswered_ = 0;
    enter(Step::kSetOutputs, now);
  } else if (step_ == Step::kSetOutputs && frame.is(Mid::kOutputConfiguration)) {
    unanswered_ = 0;
    check_outputs(frame.data);
    enter(Step::kGotoMeasurement, now);
  } else if (step_ == Step::kGotoMeasurement && (frame.is(Mid::kGotoMeasurementAck) || frame.is(Mid::kMtData2))) {
    unanswered_ = 0;
    refusal_.clear();
    enter(Step::kMeasuring, now);
  }
}

void MtConfigurator::on_error(std::int64_t now, std::span<const std::uint8_t> data) {
  counters_.add("device.errors");
  static constexpr std::array<const char*, 3> kNames = {"GotoConfig", "SetOutputConfiguration", "GotoMeasurement"};
  const std::uint8_t code = data.empty() ? std::uint8_t{0} : data[0];
  if (step_ == Step::kMeasuring) {
    error_ = fmt::format("the IMU reports error 0x{:02X}, {}", code, error_text(code));
    error_at_ = now;
    return;
  }
  refusal_ = fmt::format("the IMU refuses {}: error 0x{:02X}, {}", kNames[static_cast<std::size_t>(step_)], code,
                         error_text(code));
}

/// The device may change the requested outputs: its answer has those that it will send.
void MtConfigurator::check_outputs(std::span<const std::uint8_t> effective) {
  mismatch_.clear();
  for (const auto& [type, name] : {std::pair{0x4020, "acceleration"}, std::pair{0x8020, "rate of turn"}}) {
    int rate = 0;
    for (auto rest = effective; rest.size() >= 4; rest = rest.subspan(4)) {
      if ((read_big_endian<std::uint16_t>(rest) & kOutputTypeMask) == type)
        rate = read_big_endian<std::uint16_t>(rest.subspan(2));
    }
    if (rate != settings_.rate) {
      mismatch_ = fmt::format("the IMU sends {} at {} Hz, {} Hz was asked for", name, rate, settings_.rate);
    }
  }
}

void MtConfigurator::tick(std::int64_t now) {
  silence_.tick(now);
  if (!started_) return start(now);
  if (now - error_at_ > kErrorRemembered || now < error_at_) error_.clear();
  if (!settings_.enabled) return;
  if (step_ == Step::kMeasuring) {
    if (silence_.silent() <= settings_.patience) return;
    counters_.add("device.reconfigured");
    enter(Step::kGotoConfig, now);
  } else if (now - sent_ >= kAnswerTime || now < sent_) {
    counters_.add("device.retries");
    if (tries_ >= kMaxTries) {
      enter(Step::kGotoConfig, now);
    } else {
      send_command(now);
    }
  }
}

std::string MtConfigurator::fault() const {
  if (!refusal_.empty()) return refusal_;
  if (!error_.empty()) return error_;
  if (unanswered_ > kMaxTries) return "the IMU does not answer: wrong device, wrong baud, or not connected";
  return mismatch_;
}

}  // namespace curbstone::imu::xsens
