#include "drivers/encoder/modbus/drive_poll.hpp"

#include <fmt/format.h>

namespace curbstone::encoder::modbus {

namespace {

constexpr std::array<Block, 3> kBlocks = {kFaultsPositionsSpeeds, kPositionsSpeeds, kPositions};
constexpr int kIllegalAddress = 2;

std::string exception_counter(int code) {
  switch (code) {
    case 1:
      return "refused.illegal_function";
    case kIllegalAddress:
      return "refused.illegal_address";
    case 3:
      return "refused.illegal_value";
    case 4:
      return "refused.device_failure";
    default:
      return "refused.exception";
  }
}

std::string counter(const Reply& reply) {
  switch (reply.outcome) {
    case Outcome::kTimeout:
      return "refused.timeout";
    case Outcome::kSlow:
      return "refused.slow";
    case Outcome::kCrc:
      return "refused.crc";
    case Outcome::kWrongSlave:
      return "refused.wrong_slave";
    case Outcome::kMalformed:
      return "refused.malformed";
    case Outcome::kUnasked:
      return "refused.unasked";
    default:
      return exception_counter(reply.exception);
  }
}

std::string in_words(const Reply& reply) {
  switch (reply.outcome) {
    case Outcome::kTimeout:
      return "does not answer: power, wiring, baud rate, slave id?";
    case Outcome::kSlow:
      return "answers too late: a slow gateway, or a USB adapter that collects bytes (latency_timer)?";
    case Outcome::kException:
      return fmt::format("answers with exception {}: is it a ZLAC8015D?", reply.exception);
    default:
      return fmt::format("is not understood ({}): wiring, terminator, baud rate, two devices with one id?",
                         counter(reply));
  }
}

}  // namespace

void DrivePoll::restart() {
  level_ = 0;
  polls_ = 0;
  failures_ = 0;
  gone_ = false;
  in_step_ = false;
  asked_lines_ = false;
  reading_ = {};
}

void DrivePoll::tick(std::int64_t now) {
  now_ = now;
  share_.tick(now);
}

bool DrivePoll::read(const Block& block, std::span<std::uint16_t> registers) {
  last_ = read_(block, registers.first(static_cast<std::size_t>(block.count)));
  if (last_.outcome == Outcome::kOk) {
    counters_.add("modbus.replies");
    share_.used(now_);
    return true;
  }
  refuse(last_);
  return false;
}

void DrivePoll::refuse(const Reply& reply) {
  if (reply.outcome == Outcome::kGone) {
    gone_ = true;
    return;
  }
  const std::string name = counter(reply);
  counters_.add(name);
  share_.refused(now_, name);
  if (reply.outcome != Outcome::kException && reply.outcome != Outcome::kSlow) in_step_ = false;
}

void DrivePoll::poll(const std::function<void(const Reading&)>& on_reading) {
  if (!in_step_) {
    in_step_ = true;  // an error resets it
    read_status(kStatusHallTemperature);
    gap_();
  }
  if (!gone_ && in_step_ && read_block(on_reading)) {
    failures_ = 0;
    fault_.clear();
  } else if (++failures_ >= kMaxFailures && !gone_) {
    fault_ = fmt::format("the drive {}", in_words(last_));
  }
  if (gone_ || !in_step_) return;
  if (!asked_lines_) {
    gap_();
    read_encoder_lines();
  } else if (++polls_ % kStatusEvery == 0) {
    gap_();
    read_status(kStatus);
    if (level_ == 0) return;
    gap_();
    read_faults();
  }
}

bool DrivePoll::read_block(const std::function<void(const Reading&)>& on_reading) {
  std::array<std::uint16_t, kMaxRegisters> registers{};
  const Block& block = kBlocks[level_];
  if (!read(block, registers)) {
    const bool unknown = last_.outcome == Outcome::kException && last_.exception == kIllegalAddress;
    if (unknown && level_ + 1 < kBlocks.size()) {
      counters_.add("modbus.fallbacks");
      ++level_;
    }
    return false;
  }
  const std::span all(registers);
  reading_.utime = last_.utime;
  reading_.time = last_.time;
  reading_.round_trip = last_.round_trip;
  if (level_ == 0) {
    reading_.faults = {registers[0], registers[1]};
    reading_.faults_time = last_.time;
    reading_.counts = positions(all.subspan<2, 4>());
  } else {
    reading_.counts = positions(all.first<4>());
  }
  reading_.speeds.reset();
  if (level_ < 2) {
    const auto speeds = all.subspan(level_ == 0 ? 6 : 4, 2);
    reading_.speeds = {static_cast<std::int16_t>(speeds[0]), static_cast<std::int16_t>(speeds[1])};
  }
  on_reading(reading_);
  return true;
}

void DrivePoll::read_status(const Block& block) {
  std::array<std::uint16_t, kMaxRegisters> registers{};
  if (!read(block, registers)) return;
  reading_.state = drive_state(registers[0]);
  reading_.state_time = last_.time;
}

void DrivePoll::read_faults() {
  std::array<std::uint16_t, kMaxRegisters> registers{};
  if (!read(kFaults, registers)) return;
  reading_.faults = {registers[0], registers[1]};
  reading_.faults_time = last_.time;
}

void DrivePoll::read_encoder_lines() {
  std::array<std::uint16_t, kMaxRegisters> registers{};
  const bool ok = read(kEncoderLines, registers);
  if (ok) reading_.encoder_lines = registers[0];
  asked_lines_ = ok || last_.outcome == Outcome::kException;
}

}  // namespace curbstone::encoder::modbus
