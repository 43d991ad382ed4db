#include "drivers/encoder/can/slcan_channel.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <utility>

#include "common/time/has_passed.hpp"

namespace curbstone::encoder::can {

namespace {

constexpr std::int64_t kCloseTime = 100'000;   // us, in which answers to earlier commands arrive; they look the same
constexpr std::int64_t kAnswerTime = 300'000;  // us; some adapters never answer
constexpr std::int64_t kSilence = 2'000'000;   // us; a bus with a drive is never silent, and one in bus-off always is
constexpr std::int64_t kRetryPeriod = 1'000'000;
constexpr int kMaxRefused = 5;
constexpr std::int64_t kFlagsPeriod = 1'000'000;      // us
constexpr std::int64_t kFlagsRemembered = 3'000'000;  // us: longer than a status message takes
constexpr int kMaxUnknownFlags = 3;

struct FlagName {
  SlcanFlag flag;
  const char* counter;
  const char* words;  // null: it is not an error
};
constexpr std::array<FlagName, 7> kFlagNames = {{{kBusError, "slcan.bus_error", "bus error"},
                                                 {kErrorPassive, "slcan.error_passive", "error passive"},
                                                 {kErrorWarning, "slcan.error_warning", "error warning"},
                                                 {kDataOverrun, "slcan.data_overrun", "data overrun"},
                                                 {kReceiveFull, "slcan.receive_full", "receive queue full"},
                                                 {kTransmitFull, "slcan.transmit_full", "transmit queue full"},
                                                 {kArbitrationLost, "slcan.arbitration_lost", nullptr}}};

char speed_code(int bitrate) {
  static constexpr std::array<int, 9> kBitrates = {10, 20, 50, 100, 125, 250, 500, 800, 1000};
  for (std::size_t i = 0; i < kBitrates.size(); ++i) {
    if (kBitrates[i] == bitrate) return static_cast<char>('0' + i);
  }
  throw std::runtime_error(
      fmt::format("an SLCAN adapter has no {} kbit/s: use 10, 20, 50, 100, 125, 250, 500, 800 or 1000", bitrate));
}

}  // namespace

SlcanChannel::SlcanChannel(int bitrate, Handlers handlers)
    : speed_(speed_code(bitrate)), handlers_(std::move(handlers)) {}

void SlcanChannel::enter(State state, std::int64_t now, const std::string& command) {
  state_ = state;
  since_ = now;
  handlers_.send({reinterpret_cast<const std::uint8_t*>(command.data()), command.size()});
}

void SlcanChannel::start(std::int64_t now) {
  counters_.add("slcan.openings");
  parser_.reset();
  refused_in_a_row_ = 0;
  enter(State::kClosing, now, "\r\rC\r");  // empty lines end a command that another program left incomplete
}

void SlcanChannel::on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes) {
  parser_.parse(bytes, {[&](const CanFrame& frame) {
                          frames_.heard();
                          refused_in_a_row_ = 0;
                          if (state_ != State::kOpen) return;
                          refusal_.clear();
                          silence_.clear();
                          handlers_.on_frame(receive_utime, frame);
                        },
                        [&](SlcanParser::Answer answer) { on_answer(receive_utime, answer); },
                        [&](std::uint8_t flags) { on_flags(receive_utime, flags); },
                        [&](const char* cause) {
                          if (handlers_.on_refused) handlers_.on_refused(receive_utime, cause);
                        }});
}

void SlcanChannel::on_answer(std::int64_t now, SlcanParser::Answer answer) {
  if (state_ == State::kOpen && unanswered_ == 0) return;  // answers nothing that was sent: noise
  unanswered_ = 0;
  answers_.heard();
  const bool ok = answer == SlcanParser::Answer::kOk;
  refused_in_a_row_ = ok ? 0 : refused_in_a_row_ + 1;
  if (!ok && state_ != State::kClosing) counters_.add("slcan.refused");
  switch (state_) {
    case State::kSettingSpeed:
      enter(State::kOpening, now, "O\r");
      break;
    case State::kOpening:
      if (ok) {
        refusal_.clear();
        open(now);
      } else {
        state_ = State::kRefused;
        since_ = now;
        refusal_ = "the SLCAN adapter refuses to open its CAN channel";
      }
      break;
    case State::kOpen:
      if (refused_in_a_row_ >= kMaxRefused) start(now);  // another program has closed it
      break;
    default:
      break;
  }
}

void SlcanChannel::open(std::int64_t now) {
  state_ = State::kOpen;
  frames_.heard();
  asked_ = now;
  unknown_flags_ = 0;
  if (handlers_.on_open) handlers_.on_open(now);
}

void SlcanChannel::send(const CanFrame& frame) {
  if (state_ == State::kOpen) {
    ++unanswered_;
    handlers_.send(encode_slcan(frame));
  } else {
    counters_.add("dropped.not_open");
  }
}

void SlcanChannel::tick(std::int64_t now) {
  const auto waited = [&](std::int64_t period) { return has_passed(period, since_, now); };
  last_tick_ = now;
  frames_.tick(now);
  answers_.tick(now);
  switch (state_) {
    case State::kIdle:
      start(now);
      break;
    case State::kClosing:
      if (waited(kCloseTime)) enter(State::kSettingSpeed, now, fmt::format("S{}\r", speed_));
      break;
    case State::kSettingSpeed:
      if (waited(kAnswerTime)) enter(State::kOpening, now, "O\r");
      break;
    case State::kOpening:
      if (waited(kAnswerTime)) open(now);  // assumed to be open; a silence will show if it is not
      break;
    case State::kOpen:
      if (frames_.silent() < kSilence) {
        ask_for_flags(now);
        break;
      }
      silence_ = answers_.silent() < kSilence
                     ? "the SLCAN adapter answers, and no frame comes: bus-off, cable, or a drive without power?"
                     : "nothing from the SLCAN adapter: no frame and no answer";
      start(now);
      break;
    case State::kRefused:
      if (waited(kRetryPeriod)) start(now);
      break;
  }
}

void SlcanChannel::ask_for_flags(std::int64_t now) {
  if (!has_passed(kFlagsPeriod, asked_, now) || unknown_flags_ == kMaxUnknownFlags) return;
  asked_ = now;
  if (++unknown_flags_ == kMaxUnknownFlags) return counters_.set("slcan.flags_unknown", 1);
  static constexpr std::array<std::uint8_t, 2> kQuestion = {'F', '\r'};
  handlers_.send(kQuestion);
}

void SlcanChannel::on_flags(std::int64_t now, std::uint8_t flags) {
  if (state_ != State::kOpen) return;
  unknown_flags_ = 0;
  std::uint8_t errors = 0;
  for (const FlagName& name : kFlagNames) {
    if ((flags & name.flag) == 0) continue;
    counters_.add(name.counter);
    if (name.words != nullptr) errors = static_cast<std::uint8_t>(errors | name.flag);
  }
  if (errors == 0) return;
  flags_ = errors;
  flagged_ = now;
}

std::vector<std::string> SlcanChannel::faults() const {
  std::vector<std::string> faults;
  for (const std::string& fault : {silence_, refusal_}) {
    if (!fault.empty()) faults.push_back(fault);
  }
  if (flags_ == 0 || last_tick_ - flagged_ > kFlagsRemembered) return faults;
  std::string text;
  for (const FlagName& name : kFlagNames) {
    if (name.words != nullptr && (flags_ & name.flag) != 0)
      text += (text.empty() ? "" : ", ") + std::string(name.words);
  }
  faults.push_back(fmt::format("the SLCAN adapter reports {}: cable, terminator, bit rate, a slow host?", text));
  return faults;
}

Counters SlcanChannel::counters() const {
  Counters counters = counters_;
  counters.add(parser_.counters());
  return counters;
}

}  // namespace curbstone::encoder::can
