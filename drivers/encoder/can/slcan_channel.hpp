#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/encoder/can/slcan.hpp"

namespace curbstone::encoder::can {

/// Opens an SLCAN adapter's channel and keeps it open. It sends close, bit rate and open, and waits for each answer. It
/// does so again after a silence, a reset or a refusal: that also ends a bus-off. Each second it asks for the error
/// flags; an adapter that does not know that question is asked no more. Pure: time comes in (us), bytes and frames go
/// in and out.
///
/// Counts: slcan.openings, slcan.refused (commands), slcan.receive_full, .transmit_full, .error_warning, .data_overrun,
/// .error_passive, .arbitration_lost, .bus_error (questions that found the flag), slcan.flags_unknown (1: it has none),
/// dropped.not_open (frames to send before the channel was open), and those of SlcanParser.
class SlcanChannel {
 public:
  struct Handlers {
    std::function<void(std::span<const std::uint8_t>)> send;
    std::function<void(std::int64_t receive_utime, const CanFrame&)> on_frame;
    std::function<void(std::int64_t now)> on_open;  ///< frames can be sent from now on
    std::function<void(std::int64_t now, const char* cause)> on_refused = {};
  };

  /// `bitrate` kbit/s; throws std::runtime_error if it is none of the adapter's.
  SlcanChannel(int bitrate, Handlers handlers);

  /// (Re)starts from the beginning: the port was opened.
  void start(std::int64_t now);
  void on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes);
  void send(const CanFrame& frame);
  void tick(std::int64_t now);

  [[nodiscard]] bool is_open() const { return state_ == State::kOpen; }
  [[nodiscard]] std::vector<std::string> faults() const;
  [[nodiscard]] Counters counters() const;

 private:
  enum class State { kIdle, kClosing, kSettingSpeed, kOpening, kOpen, kRefused };

  void enter(State state, std::int64_t now, const std::string& command);
  void open(std::int64_t now);
  void ask_for_flags(std::int64_t now);
  void on_flags(std::int64_t now, std::uint8_t flags);
  void on_answer(std::int64_t now, SlcanParser::Answer answer);

  char speed_;
  Handlers handlers_;
  SlcanParser parser_;
  State state_ = State::kIdle;
  std::int64_t since_ = 0;        // us, when the state began
  std::int64_t last_frame_ = 0;   // us; or when it was opened
  std::int64_t last_answer_ = 0;  // us
  int unanswered_ = 0;            // frames sent
  int refused_in_a_row_ = 0;
  std::string refusal_;       // the last fault of the opening,
  std::string silence_;       // and of the bus, until a frame comes
  std::int64_t asked_ = 0;    // us, when the flags were asked for
  int unknown_flags_ = 0;     // questions in a row without an answer
  std::int64_t flagged_ = 0;  // us, when flags were last found that are errors
  std::int64_t last_tick_ = 0;
  std::uint8_t flags_ = 0;
  Counters counters_;
};

}  // namespace curbstone::encoder::can
