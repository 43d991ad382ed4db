#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::simulate::devices {

/// A serial CAN adapter (Lawicel's ASCII protocol) as the host's serial port sees it. Pure: bytes and frames in and
/// out.
class SlcanEmulator {
 public:
  struct Result {
    std::vector<std::uint8_t> to_host;           ///< answers: CR, or BELL where the command is refused
    std::vector<encoder::can::CanFrame> to_bus;  ///< frames the host sends
  };

  /// What the host wrote.
  Result on_bytes(std::span<const std::uint8_t> bytes);
  /// A frame on the bus; nothing while the channel is closed.
  [[nodiscard]] std::vector<std::uint8_t> on_frame(const encoder::can::CanFrame& frame) const;
  /// The adapter loses power, or is plugged in again: the channel is closed and has no speed.
  void reset() { *this = {}; }

  /// Error flags, until the host has asked for them: encoder::can::SlcanFlag.
  void set_flags(std::uint8_t flags) { flags_ = flags; }

  [[nodiscard]] bool is_open() const { return open_; }

 private:
  void on_line(Result& result);

  std::string line_;
  bool has_speed_ = false;
  bool open_ = false;
  std::uint8_t flags_ = 0;
};

}  // namespace curbstone::simulate::devices
