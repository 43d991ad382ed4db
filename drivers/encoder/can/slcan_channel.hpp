#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "common/bus/counters.hpp"
#include "drivers/encoder/can/slcan.hpp"

namespace curbstone::encoder::can {

/// Opens an SLCAN adapter's channel and keeps it open. It sends close, bit rate and open, and waits for each answer. It
/// does so again after a silence, a reset or a refusal. Pure: time comes in (us), bytes and frames go in and out.
///
/// Counts: slcan.openings, slcan.refused (commands), dropped.not_open (frames to send before the channel was open), and
/// those of SlcanParser.
class SlcanChannel {
 public:
  struct Handlers {
    std::function<void(std::span<const std::uint8_t>)> send;
    std::function<void(std::int64_t receive_utime, const CanFrame&)> on_frame;
    std::function<void(std::int64_t now)> on_open;  ///< frames can be sent from now on
  };

  /// `bitrate` kbit/s; throws std::runtime_error if it is none of the adapter's.
  SlcanChannel(int bitrate, Handlers handlers);

  /// (Re)starts from the beginning: the port was opened.
  void start(std::int64_t now);
  void on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes);
  void send(const CanFrame& frame);
  void tick(std::int64_t now);

  [[nodiscard]] bool is_open() const { return state_ == State::kOpen; }
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] Counters counters() const;

 private:
  enum class State { kIdle, kClosing, kSettingSpeed, kOpening, kOpen, kRefused };

  void enter(State state, std::int64_t now, const std::string& command);
  void open(std::int64_t now);
  void on_answer(std::int64_t now, SlcanParser::Answer answer);

  char speed_;
  Handlers handlers_;
  SlcanParser parser_;
  State state_ = State::kIdle;
  std::int64_t since_ = 0;       // us, when the state began
  std::int64_t last_heard_ = 0;  // us, anything from the adapter
  int unanswered_ = 0;           // frames sent
  int refused_in_a_row_ = 0;
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone::encoder::can
