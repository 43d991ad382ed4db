#include "drivers/encoder/can/slcan_channel.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <utility>

namespace curbstone::encoder::can {

namespace {

constexpr std::int64_t kCloseTime = 100'000;   // us; answers to what was pending are not told apart from ours
constexpr std::int64_t kAnswerTime = 300'000;  // us; some adapters never answer
constexpr std::int64_t kSilence = 2'000'000;   // us; a bus with a drive is never silent
constexpr std::int64_t kRetryPeriod = 1'000'000;
constexpr int kMaxRefused = 5;

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
  last_heard_ = now;
  refused_in_a_row_ = 0;
  enter(State::kClosing, now, "\r\rC\r");  // empty lines end what somebody left half-typed
}

void SlcanChannel::on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes) {
  parser_.parse(bytes, {[&](const CanFrame& frame) {
                          last_heard_ = receive_utime;
                          refused_in_a_row_ = 0;
                          if (state_ == State::kOpen) fault_.clear();
                          if (state_ == State::kOpen) handlers_.on_frame(receive_utime, frame);
                        },
                        [&](SlcanParser::Answer answer) { on_answer(receive_utime, answer); }});
}

void SlcanChannel::on_answer(std::int64_t now, SlcanParser::Answer answer) {
  if (state_ == State::kOpen && unanswered_ == 0) return;  // to nothing that we sent: noise
  unanswered_ = 0;
  last_heard_ = now;
  const bool ok = answer == SlcanParser::Answer::kOk;
  refused_in_a_row_ = ok ? 0 : refused_in_a_row_ + 1;
  if (!ok && state_ != State::kClosing) counters_.add("slcan.refused");
  switch (state_) {
    case State::kSettingSpeed:
      enter(State::kOpening, now, "O\r");
      break;
    case State::kOpening:
      if (ok) {
        fault_.clear();
        open(now);
      } else {
        state_ = State::kRefused;
        since_ = now;
        fault_ = "the SLCAN adapter refuses to open its CAN channel";
      }
      break;
    case State::kOpen:
      if (refused_in_a_row_ >= kMaxRefused) start(now);  // it was closed behind our back
      break;
    default:
      break;
  }
}

void SlcanChannel::open(std::int64_t now) {
  state_ = State::kOpen;
  last_heard_ = now;
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
  const std::int64_t elapsed = now - since_;
  switch (state_) {
    case State::kIdle:
      start(now);
      break;
    case State::kClosing:
      if (elapsed >= kCloseTime) enter(State::kSettingSpeed, now, fmt::format("S{}\r", speed_));
      break;
    case State::kSettingSpeed:
      if (elapsed >= kAnswerTime) enter(State::kOpening, now, "O\r");
      break;
    case State::kOpening:
      if (elapsed >= kAnswerTime) open(now);  // on trust; silence will tell
      break;
    case State::kOpen:
      if (now - last_heard_ < kSilence) break;
      fault_ = "nothing from the SLCAN adapter: no frame and no answer";
      start(now);
      break;
    case State::kRefused:
      if (elapsed >= kRetryPeriod) start(now);
      break;
  }
}

Counters SlcanChannel::counters() const {
  Counters counters = counters_;
  for (const auto& [name, value] : parser_.counters().values()) counters.add(name, value);
  return counters;
}

}  // namespace curbstone::encoder::can
