#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/time/silence_timer.hpp"
#include "drivers/encoder/can/slcan.hpp"

namespace curbstone::encoder::can {

/// Opens an SLCAN adapter's channel and keeps it open. Sends close, bit rate and open, and waits for each answer.
/// Repeats this after a silence, a reset or a refusal, which also ends a bus-off. Requests the error flags each second;
/// an adapter that does not know that request is not asked again. Pure: time (us), bytes and frames are arguments, and
/// output goes to the handlers.
///
/// Counts: slcan.openings, slcan.refused (commands), slcan.receive_full, .transmit_full, .error_warning, .data_overrun,
/// .error_passive, .arbitration_lost, .bus_error (requests that found the flag), slcan.flags_unknown (1: it has none),
/// dropped.not_open (frames to send before the channel was open), and those of SlcanParser.
class SlcanChannel {
 public:
  struct Handlers {
    std::function<void(std::span<const std::uint8_t>)> send;
    std::function<void(std::int64_t receive_utime, const CanFrame&)> on_frame;
    std::function<void(std::int64_t now)> on_open;  ///< frames can be sent from now on
    std::function<void(std::int64_t now, const char* cause)> on_refused = {};
  };

  /// `bitrate` in kbit/s; throws std::runtime_error if the adapter does not support it.
  SlcanChannel(int bitrate, Handlers handlers);

  /// (Re)starts from the beginning, when the port was opened.
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
  std::int64_t since_ = 0;  // us, begin of the state
  SilenceTimer frames_;     // since the latest frame, else since the opening
  SilenceTimer answers_;
  int unanswered_ = 0;  // frames sent
  int refused_in_a_row_ = 0;
  std::string refusal_;       // fault of the latest opening
  std::string silence_;       // fault of the bus, until a frame is received
  std::int64_t asked_ = 0;    // us, of the latest request for flags
  int unknown_flags_ = 0;     // consecutive requests without an answer
  std::int64_t flagged_ = 0;  // us, of the latest error flags
  std::int64_t last_tick_ = 0;
  std::uint8_t flags_ = 0;
  Counters counters_;
};

}  // namespace curbstone::encoder::can
