#include "drivers/encoder/canopen/wheel_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/bytes/little_endian.hpp"
#include "common/time/has_passed.hpp"

namespace curbstone::encoder::canopen {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::Object;

namespace {

constexpr Object kHeartbeatPeriod{0x1017, 0};
constexpr Object kEncoderLines{0x200E, 1};
constexpr Object kFaults{0x603F, 0};
constexpr Object kStatusWords{0x6041, 0};
constexpr Object kPositionLeft{0x6064, 1};
constexpr Object kPositionRight{0x6064, 2};
constexpr Object kSpeeds{0x606C, 3};

constexpr std::int64_t kStatusPeriod = 100'000;        // us, of TPDO2
constexpr std::int64_t kPollPeriod = 1'000'000;        // us, of the fault word
constexpr std::int64_t kSetUpRetryPeriod = 1'000'000;  // us, after a set-up that failed

constexpr std::int64_t kOldFaults = 5'000'000;          // us, of the fault word: five polls
constexpr std::int64_t kHeartbeatPatience = 3'000'000;  // us: three periods of the slowest usual heartbeat

bool is_state(NmtState state) {
  return state == NmtState::kBootUp || state == NmtState::kStopped || state == NmtState::kOperational ||
         state == NmtState::kPreOperational;
}

/// CiA 402 "fault" or "fault reaction", or the drive's own alarm bit.
bool in_alarm(std::uint16_t word) {
  return (word & 0x4F) == 0x08 || (word & 0x4F) == 0x0F || (word & 0x80) != 0;
}

/// Of a status word: whether the wheel is powered, and in alarm. The other bits come and go as it turns.
constexpr std::uint16_t kStateBits = 0xEF;

/// Low half left, high half right: measured for the speeds, probable for status and faults (encoders_can.md, B4).
std::array<std::uint16_t, 2> halves(std::uint32_t value) {
  return {static_cast<std::uint16_t>(value), static_cast<std::uint16_t>(value >> 16)};
}

}  // namespace

bool DriveStatus::enabled(std::int64_t now) const {
  const auto on = [](std::uint16_t bits) { return (bits & 0x6F) == 0x27 && (bits & 0x80) == 0; };
  const bool known = word_utime != 0 && now - word_utime <= kOldStatus;
  return known && emergency == 0 && on(word[0]) && on(word[1]) && faults[0] == 0 && faults[1] == 0;
}

WheelDrive::WheelDrive(const Settings& settings, Handlers handlers)
    : settings_(settings), handlers_(std::move(handlers)), sdo_(settings.node, handlers_.send) {}

std::vector<std::uint32_t> WheelDrive::ids(std::uint8_t node) {
  std::vector<std::uint32_t> ids = {canopen::kEmergency, canopen::kTpdo1, canopen::kTpdo2, canopen::kSdoReply,
                                    canopen::kHeartbeat};
  for (std::uint32_t& id : ids) id += node;
  return ids;
}

Counters WheelDrive::counters() const {
  Counters counters = counters_;
  counters.add(sdo_.counters());
  return counters;
}

std::vector<std::string> WheelDrive::faults() const {
  std::vector<std::string> faults;
  if (!fault_.empty()) faults.push_back(fault_);
  if (state_ == State::kIdle) return faults;
  if (boots_.often(last_tick_))
    faults.push_back(fmt::format("the drive has restarted {} times within a minute: its supply?", kManyBoots));
  const auto check_age = [&](const char* what, std::int64_t utime, std::int64_t most) {
    const std::int64_t age = last_tick_ - (utime != 0 ? utime : began_);
    if (age > most)
      faults.push_back(fmt::format("the drive's {} not known for {:.0f} s", what, static_cast<double>(age) * 1e-6));
  };
  check_age("status is", status_.word_utime, DriveStatus::kOldStatus);
  if (settings_.configure) check_age("fault word is", status_.faults_utime, kOldFaults);
  if (last_heartbeat_ != 0 && last_tick_ - last_heartbeat_ > kHeartbeatPatience) {
    faults.push_back(fmt::format("the drive's heartbeat stays away for {:.0f} s",
                                 static_cast<double>(last_tick_ - last_heartbeat_) * 1e-6));
  }
  if (state_ == State::kRunning && nmt_state_ != NmtState::kOperational && nmt_state_ != NmtState::kBootUp) {
    faults.push_back(fmt::format("another master has made the drive {}",
                                 nmt_state_ == NmtState::kStopped ? "stopped" : "pre-operational"));
  }
  if (status_.emergency != 0) {
    faults.push_back(
        fmt::format("drive: emergency {:04X}, error register {:02X}", status_.emergency, status_.error_register));
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (status_.word_utime != 0 && status_.faults[i] == 0 && in_alarm(status_.word[i]))
      faults.push_back(
          fmt::format("drive, {} wheel: alarm (status word {:04X})", i == 0 ? "left" : "right", status_.word[i]));
  }
  return faults;
}

/// While driving, a change is sent at most every inhibit time; at standstill, every event timer. Both are set to the
/// period, so that the positions are evenly spaced.
std::vector<WheelDrive::Write> WheelDrive::setup_sequence() const {
  std::vector<Write> writes;
  const auto map_pdo = [&](std::uint16_t communication, std::int64_t period, Object first, Object second) {
    const auto map = static_cast<std::uint16_t>(communication + 0x200);
    writes.push_back({{map, 0}, 1, 0, true});
    writes.push_back({{map, 1}, 4, canopen::mapping(first, 32), true});
    writes.push_back({{map, 2}, 4, canopen::mapping(second, 32), true});
    writes.push_back({{communication, 2}, 1, 0xFF, true});
    writes.push_back({{communication, 3}, 2, static_cast<std::uint32_t>(period / 100), true});
    writes.push_back({{communication, 5}, 2, static_cast<std::uint32_t>(period / settings_.event_timer_unit), true});
    writes.push_back({{map, 0}, 1, 2, true});
  };
  map_pdo(0x1800, settings_.period, kPositionLeft, kPositionRight);
  map_pdo(0x1801, kStatusPeriod, kStatusWords, kSpeeds);
  writes.push_back({kHeartbeatPeriod, 2, static_cast<std::uint32_t>(settings_.heartbeat_period), false});
  return writes;
}

void WheelDrive::start(std::int64_t now) {
  began_ = now;
  last_heartbeat_ = 0;
  nodes_.forget();
  is_heard_ = false;
  lines_read_ = faults_read_ = {};
  status_ = {};  // it may be another drive, or have been switched off and on
  pdos_ = {};
  restart(now);
}

/// The latest EMCY is kept: only the drive takes it back.
void WheelDrive::restart(std::int64_t now) {
  sdo_.cancel();
  status_.word_utime = status_.faults_utime = 0;
  latest_words_.reset();
  nmt_state_ = NmtState::kOperational;
  since_ = now;
  handlers_.on_stop();
  if (!settings_.configure) {
    run(now);
    return;
  }
  counters_.add("drive.setups");
  state_ = State::kSettingUp;
  sequence_ = setup_sequence();
  step_ = 0;
  handlers_.send(canopen::nmt(NmtCommand::kPreOperational, settings_.node));
  next_write(now);
}

void WheelDrive::next_write(std::int64_t now) {
  if (step_ == sequence_.size()) {
    handlers_.send(canopen::nmt(NmtCommand::kStart, settings_.node));
    run(now);
    return;
  }
  const Write& write = sequence_[step_];
  sdo_.write(now, write.object, write.size, write.value, [this](std::int64_t at, const SdoClient::Result& result) {
    const Write& done = sequence_[step_];
    using Status = SdoClient::Result::Status;
    if (result.status == Status::kNoAnswer) {
      fail(at, fmt::format("the drive (CAN node {}) does not answer: power, bus, bit rate or node id?{}",
                           settings_.node, heard_instead()));
    } else if (result.status == Status::kAborted && done.required) {
      fail(at, fmt::format("the drive (CAN node {}) refuses object {:04X}:{:02X}: abort {:08X}", settings_.node,
                           done.object.index, done.object.sub, result.value));
    } else {
      ++step_;
      next_write(at);
    }
  });
}

void WheelDrive::run(std::int64_t now) {
  state_ = State::kRunning;
  answers_start_ = settings_.configure;
  since_ = last_counts_ = now;
  fault_.clear();
}

void WheelDrive::fail(std::int64_t now, std::string why) {
  state_ = State::kFailed;
  since_ = now;
  fault_ = std::move(why);
}

bool WheelDrive::is_from_drive(const can::CanFrame& frame) const {
  if (frame.extended || frame.remote) return false;
  const std::uint32_t kind = frame.id - settings_.node;
  return kind == canopen::kTpdo1 || kind == canopen::kTpdo2 || kind == canopen::kSdoReply ||
         kind == canopen::kHeartbeat || kind == canopen::kEmergency;
}

void WheelDrive::on_frame(std::int64_t receive_utime, const can::CanFrame& frame) {
  if (state_ == State::kIdle) start(receive_utime);
  refusal_ = nullptr;
  nodes_.add(frame);
  is_heard_ = is_heard_ || is_from_drive(frame);
  if (frame.extended || frame.remote) {
    counters_.add("ignored.frames");
  } else if (frame.id == canopen::kTpdo1 + settings_.node) {
    if (state_ != State::kRunning) return counters_.add("ignored.unconfigured");
    if (frame.size != 8) return refuse("refused.length");
    last_counts_ = receive_utime;
    pdos_.add_positions(frame);
    if (std::exchange(answers_start_, false)) {
      answer_ = frame;
      answered_ = receive_utime;
      return counters_.add("ignored.first");
    }
    if (frame == answer_ && receive_utime - answered_ < settings_.period / 4) return counters_.add("ignored.first");
    answer_.reset();
    const auto left = read_little_endian<std::uint32_t>(frame.bytes());
    const auto right = read_little_endian<std::uint32_t>(frame.bytes().subspan(4));
    handlers_.on_counts(receive_utime, {static_cast<std::int32_t>(left), static_cast<std::int32_t>(right)});
  } else if (frame.id == canopen::kTpdo2 + settings_.node) {
    if (state_ != State::kRunning) return counters_.add("ignored.unconfigured");
    if (frame.size != 8) return refuse("refused.length");
    on_status(receive_utime, frame);
  } else if (frame.id == canopen::kSdoReply + settings_.node) {
    sdo_.on_frame(receive_utime, frame);
  } else if (frame.id == canopen::kHeartbeat + settings_.node) {
    on_heartbeat(receive_utime, frame);
  } else if (frame.id == canopen::kEmergency + settings_.node) {
    on_emergency(frame);
  } else {
    counters_.add("ignored.frames");
  }
}

void WheelDrive::refuse(const char* cause) {
  counters_.add(cause);
  refusal_ = cause;
}

void WheelDrive::on_heartbeat(std::int64_t now, const can::CanFrame& frame) {
  if (frame.size != 1) return refuse("refused.length");
  const auto state = static_cast<NmtState>(frame.data[0] & 0x7F);
  if (!is_state(state)) return refuse("refused.heartbeat");
  last_heartbeat_ = state == NmtState::kBootUp ? 0 : now;  // a boot-up promises no heartbeats
  const bool confirmed = std::exchange(latest_state_, state) == state;
  if (confirmed) nmt_state_ = state;
  if (state == NmtState::kBootUp) {  // the set-up is lost
    counters_.add("drive.boots");
    boots_.add(now);
    handlers_.on_restart();
    status_ = {};
    restart(now);
  } else if (state_ == State::kRunning && confirmed && state != NmtState::kOperational &&
             now - since_ > settings_.patience) {
    counters_.add("drive.stops");
    restart(now);
    nmt_state_ = state;
  }
}

void WheelDrive::on_status(std::int64_t now, const can::CanFrame& frame) {
  pdos_.add_status(frame);
  const auto words = halves(read_little_endian<std::uint32_t>(frame.bytes()));
  const auto before = std::exchange(latest_words_, words);
  if (!before) return;
  for (std::size_t i = 0; i < 2; ++i) {
    if (((words[i] ^ (*before)[i]) & kStateBits) != 0) return;
  }
  status_.word = words;
  status_.word_utime = now;
  const auto speeds = halves(read_little_endian<std::uint32_t>(frame.bytes().subspan(4)));
  for (std::size_t i = 0; i < 2; ++i) status_.speed[i] = static_cast<std::int16_t>(speeds[i]);
}

void WheelDrive::on_emergency(const can::CanFrame& frame) {
  if (frame.size != 8) return refuse("refused.length");
  const auto code = read_little_endian<std::uint16_t>(frame.bytes());
  if (code != 0 && (frame.data[2] == 0 || pdos_.resembles(frame))) {
    poll_now_ = true;  // if it was one, the fault word tells
    return refuse("refused.emergency");
  }
  status_.emergency = code;
  status_.error_register = status_.emergency != 0 ? frame.data[2] : std::uint8_t{0};
  if (status_.emergency != 0) counters_.add("drive.emergencies");
  poll_now_ = true;  // the message says that there is a fault, the fault word says which
}

void WheelDrive::tick(std::int64_t now) {
  if (state_ == State::kIdle) return start(now);
  // A process that was suspended has not read the drive's frames either: they are waiting, and are read before the next
  // tick.
  const bool slept = now - std::exchange(last_tick_, now) > settings_.patience / 2;
  sdo_.tick(now);
  if (state_ == State::kFailed && has_passed(kSetUpRetryPeriod, since_, now)) restart(now);
  if (state_ != State::kRunning) return;
  if (now - last_counts_ > settings_.patience && !slept) {
    counters_.add("drive.silences");
    restart(now);
    return;
  }
  poll(now);
}

void WheelDrive::poll(std::int64_t now) {
  if (!settings_.configure || sdo_.busy()) return;  // a listener leaves the SDO channel to the other master
  using Status = SdoClient::Result::Status;
  if (!encoder_lines_) {
    sdo_.read(now, kEncoderLines, [this](std::int64_t, const SdoClient::Result& result) {
      const bool answered = result.status == Status::kOk;
      if (!answered || lines_read_.add(result.value)) encoder_lines_ = answered ? result.value : 0;
    });
  } else if (poll_now_ || has_passed(kPollPeriod, last_poll_, now)) {
    poll_now_ = false;
    last_poll_ = now;
    sdo_.read(now, kFaults, [this](std::int64_t at, const SdoClient::Result& result) {
      if (result.status != Status::kOk) return;
      poll_now_ = !faults_read_.add(result.value);
      if (poll_now_) return;
      status_.faults = halves(result.value);
      status_.faults_utime = at;
      if (result.value == 0) status_.emergency = status_.error_register = 0;
    });
  }
}

}  // namespace curbstone::encoder::canopen
