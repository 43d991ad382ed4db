#include "tools/simulate/devices/can_drive_emulator.hpp"

#include <algorithm>
#include <cmath>

#include "common/bytes/little_endian.hpp"

namespace curbstone::simulate::devices {

using encoder::canopen::NmtCommand;
using encoder::canopen::NmtState;
using encoder::canopen::Object;
using encoder::canopen::SdoCommand;

namespace {

constexpr std::uint8_t kMaxMapped = 8;

/// Number of bytes that a write command carries; 0 for other commands.
std::uint8_t written_size(encoder::canopen::SdoCommand command) {
  switch (command) {
    case encoder::canopen::SdoCommand::kWrite1:
      return 1;
    case encoder::canopen::SdoCommand::kWrite2:
      return 2;
    case encoder::canopen::SdoCommand::kWrite3:
      return 3;
    case encoder::canopen::SdoCommand::kWrite4:
      return 4;
    default:
      return 0;
  }
}

encoder::canopen::SdoCommand read_reply(std::uint8_t size) {
  return size == 1   ? encoder::canopen::SdoCommand::kReadReply1
         : size == 2 ? encoder::canopen::SdoCommand::kReadReply2
                     : encoder::canopen::SdoCommand::kReadReply4;
}

}  // namespace

CanDriveEmulator::CanDriveEmulator(const Settings& settings) : settings_(settings) {
  load_defaults();
}

void CanDriveEmulator::load_defaults() {
  dictionary_ = {
      {{0x1000, 0}, {4, false, 0x00040192}}, {{0x1017, 0}, {2, true, 0}},  {{0x200E, 1}, {2, false, 1024}},
      {{0x200E, 2}, {2, false, 1024}},       {{0x2000, 0}, {2, true, 0}},  {{0x603F, 0}, {4, false, 0}},
      {{0x6040, 0}, {2, true, 0}},           {{0x6041, 0}, {4, false, 0}}, {{0x6064, 1}, {4, false, 0}},
      {{0x6064, 2}, {4, false, 0}},          {{0x606C, 1}, {4, false, 0}}, {{0x606C, 2}, {4, false, 0}},
      {{0x606C, 3}, {4, false, 0}},
  };
  pdos_ = {{encoder::canopen::kTpdo1 + settings_.node, 0x1800, 0, {}},
           {encoder::canopen::kTpdo2 + settings_.node, 0x1801, 0, {}}};
  for (const Pdo& pdo : pdos_) {
    const auto mapping = static_cast<std::uint16_t>(pdo.communication + 0x200);
    dictionary_[{pdo.communication, 1}] = {4, false, pdo.id};
    dictionary_[{pdo.communication, 2}] = {1, true, 0xFF};
    dictionary_[{pdo.communication, 3}] = {2, true, 0};
    dictionary_[{pdo.communication, 5}] = {2, true, 0};
    dictionary_[{mapping, 0}] = {1, true, 0};  // empty: nothing is sent until objects are mapped
    for (std::uint8_t sub = 1; sub <= kMaxMapped; ++sub) dictionary_[{mapping, sub}] = {4, true, 0};
  }
  update_status();
}

CanDriveEmulator::Frames CanDriveEmulator::power_on(std::int64_t now) {
  powered_ = true;
  load_defaults();
  enter(encoder::canopen::NmtState::kPreOperational, now);
  return {heartbeat(encoder::canopen::NmtState::kBootUp)};
}

CanDriveEmulator::Frames CanDriveEmulator::on_frame(std::int64_t now, const encoder::can::CanFrame& frame) {
  if (!powered_ || frame.extended || frame.remote) return {};
  if (frame.id == encoder::canopen::kNmt && frame.size == 2 &&
      (frame.data[1] == 0 || frame.data[1] == settings_.node)) {
    switch (static_cast<encoder::canopen::NmtCommand>(frame.data[0])) {
      case encoder::canopen::NmtCommand::kStart:
        enter(encoder::canopen::NmtState::kOperational, now);
        return tick(now);
      case encoder::canopen::NmtCommand::kStop:
        enter(encoder::canopen::NmtState::kStopped, now);
        return {};
      case encoder::canopen::NmtCommand::kPreOperational:
        enter(encoder::canopen::NmtState::kPreOperational, now);
        return {};
      case encoder::canopen::NmtCommand::kResetNode:
      case encoder::canopen::NmtCommand::kResetCommunication:
        return power_on(now);
    }
    return {};
  }
  const bool is_request = frame.id == encoder::canopen::kSdoRequest + settings_.node && frame.size == 8;
  if (is_request && state_ != encoder::canopen::NmtState::kStopped &&
      frame.data[0] != static_cast<std::uint8_t>(encoder::canopen::SdoCommand::kAbort)) {
    return {answer_sdo(frame)};
  }
  return {};
}

encoder::can::CanFrame CanDriveEmulator::answer_sdo(const encoder::can::CanFrame& request) {
  const auto command = static_cast<encoder::canopen::SdoCommand>(request.data[0]);
  const encoder::canopen::Object object{read_little_endian<std::uint16_t>(request.bytes().subspan(1)), request.data[3]};
  const auto reply = [&](encoder::canopen::SdoCommand answer, std::uint32_t data) {
    return encoder::canopen::sdo(encoder::canopen::kSdoReply + settings_.node, answer, object, data);
  };
  const auto entry = dictionary_.find(object);
  if (entry == dictionary_.end()) {
    const auto same_index = dictionary_.lower_bound({object.index, 0});
    const bool index_exists = same_index != dictionary_.end() && same_index->first.index == object.index;
    return reply(encoder::canopen::SdoCommand::kAbort,
                 index_exists ? encoder::canopen::kAbortNoSubIndex : encoder::canopen::kAbortNoObject);
  }
  if (command == encoder::canopen::SdoCommand::kRead) return reply(read_reply(entry->second.size), entry->second.value);
  const std::uint8_t size = written_size(command);
  if (size == 0) return reply(encoder::canopen::SdoCommand::kAbort, encoder::canopen::kAbortUnknownCommand);
  if (!entry->second.writable) return reply(encoder::canopen::SdoCommand::kAbort, encoder::canopen::kAbortReadOnly);
  if (size != entry->second.size) return reply(encoder::canopen::SdoCommand::kAbort, encoder::canopen::kAbortLength);
  entry->second.value = read_little_endian<std::uint32_t>(request.bytes().subspan(4));
  return reply(encoder::canopen::SdoCommand::kWriteReply, 0);
}

void CanDriveEmulator::enter(encoder::canopen::NmtState state, std::int64_t now) {
  state_ = state;
  last_heartbeat_ = now;
  for (Pdo& pdo : pdos_) {  // each is sent once when the node becomes operational
    pdo.last_data.clear();
    pdo.last_sent = now;
  }
}

CanDriveEmulator::Frames CanDriveEmulator::tick(std::int64_t now) {
  Frames frames;
  if (!powered_) return frames;
  for (Pdo& pdo : pdos_) {
    const auto at = due(pdo);
    if (!at || *at > now) continue;
    pdo.last_data = pdo_data(pdo);
    // The timer keeps its phase: a late tick is jitter, not a slower clock. After a long pause it restarts.
    pdo.last_sent = now - *at < 1'000'000 ? *at : now;
    encoder::can::CanFrame frame;
    frame.id = pdo.id;
    frame.size = static_cast<std::uint8_t>(pdo.last_data.size());
    std::copy(pdo.last_data.begin(), pdo.last_data.end(), frame.data.begin());
    frames.push_back(frame);
  }
  if (const auto at = heartbeat_due(); at && *at <= now) {
    last_heartbeat_ = now - *at < 1'000'000 ? *at : now;
    frames.push_back(heartbeat(state_));
  }
  return frames;
}

std::optional<std::int64_t> CanDriveEmulator::next_due() const {
  if (!powered_) return {};
  std::optional<std::int64_t> next = heartbeat_due();
  for (const Pdo& pdo : pdos_) {
    if (const auto at = due(pdo); at && (!next || *at < *next)) next = at;
  }
  return next;
}

std::optional<std::int64_t> CanDriveEmulator::due(const Pdo& pdo) const {
  if (state_ != encoder::canopen::NmtState::kOperational) return {};
  const std::vector<std::uint8_t> data = pdo_data(pdo);
  if (data.empty()) return {};
  if (pdo.last_data.empty()) return pdo.last_sent;
  std::optional<std::int64_t> at;
  const double event_timer = value(pdo.communication, 5);
  if (event_timer > 0) at = pdo.last_sent + device_time(event_timer * static_cast<double>(settings_.event_timer_unit));
  if (data != pdo.last_data) {
    const auto change = pdo.last_sent + device_time(value(pdo.communication, 3) * 100.0);
    at = at ? std::min(*at, change) : change;
  }
  return at;
}

std::optional<std::int64_t> CanDriveEmulator::heartbeat_due() const {
  const double period = value(0x1017, 0);
  if (!powered_ || period == 0) return {};
  return last_heartbeat_ + device_time(period * static_cast<double>(settings_.heartbeat_unit));
}

std::vector<std::uint8_t> CanDriveEmulator::pdo_data(const Pdo& pdo) const {
  const auto mapping = static_cast<std::uint16_t>(pdo.communication + 0x200);
  std::vector<std::uint8_t> data;
  const std::uint32_t count = std::min<std::uint32_t>(value(mapping, 0), kMaxMapped);
  for (std::uint32_t sub = 1; sub <= count; ++sub) {
    const std::uint32_t entry = value(mapping, static_cast<std::uint8_t>(sub));
    const std::uint32_t number = value(static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8));
    for (std::uint32_t bit = 0; bit < (entry & 0xFF) && data.size() < 8; bit += 8) {
      data.push_back(bit < 32 ? static_cast<std::uint8_t>(number >> bit) : std::uint8_t{0});
    }
  }
  return data;
}

encoder::can::CanFrame CanDriveEmulator::heartbeat(encoder::canopen::NmtState state) const {
  return encoder::can::CanFrame::make(encoder::canopen::kHeartbeat + settings_.node,
                                      {static_cast<std::uint8_t>(state)});
}

encoder::can::CanFrame CanDriveEmulator::emergency() const {
  const std::uint32_t faults = value(0x603F, 0);
  const bool any = faults != 0;
  encoder::can::CanFrame frame =
      encoder::can::CanFrame::make(encoder::canopen::kEmergency + settings_.node, {0, 0, 0, 0, 0, 0, 0, 0});
  write_little_endian<std::uint16_t>(frame.data, any ? 0x1000 : 0x0000);
  frame.data[2] = any ? 0x81 : 0x00;
  write_little_endian(std::span(frame.data).subspan(3), faults);
  return frame;
}

void CanDriveEmulator::set_counts(std::int32_t left, std::int32_t right) {
  set(0x6064, 1, static_cast<std::uint32_t>(left));
  set(0x6064, 2, static_cast<std::uint32_t>(right));
}

void CanDriveEmulator::set_speeds(std::int16_t left, std::int16_t right) {
  set(0x606C, 1, static_cast<std::uint32_t>(left));
  set(0x606C, 2, static_cast<std::uint32_t>(right));
  set(0x606C, 3,
      static_cast<std::uint32_t>(static_cast<std::uint16_t>(right)) << 16 | static_cast<std::uint16_t>(left));
}

void CanDriveEmulator::set_enabled(bool enabled) {
  enabled_ = enabled;
  update_status();
}

CanDriveEmulator::Frames CanDriveEmulator::set_faults(std::uint16_t left, std::uint16_t right) {
  set(0x603F, 0, std::uint32_t{right} << 16 | left);
  update_status();
  return powered_ && state_ != encoder::canopen::NmtState::kStopped ? Frames{emergency()} : Frames{};
}

void CanDriveEmulator::update_status() {
  const std::uint32_t faults = value(0x603F, 0);
  const auto half = [&](std::uint32_t fault) -> std::uint32_t {
    if (fault != 0) return 0x00A8;  // fault, alarm
    return enabled_ ? 0x0027 : 0x1421;
  };
  set(0x6041, 0, half(faults >> 16) << 16 | half(faults & 0xFFFF));
}

std::uint32_t CanDriveEmulator::value(std::uint16_t index, std::uint8_t sub) const {
  const auto entry = dictionary_.find({index, sub});
  return entry == dictionary_.end() ? 0 : entry->second.value;
}

void CanDriveEmulator::set(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  dictionary_.at({index, sub}).value = value;
}

std::int64_t CanDriveEmulator::device_time(double us) const {
  return std::llround(us / (1.0 + settings_.clock_error));
}

}  // namespace curbstone::simulate::devices
