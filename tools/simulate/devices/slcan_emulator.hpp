#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::simulate::devices {

/// A serial CAN adapter (Lawicel's ASCII protocol) seen from the host's serial port. Pure: bytes and frames in and out.
class SlcanEmulator {
 public:
  struct Result {
    std::vector<std::uint8_t> to_host;           ///< responses: CR, or BELL if the command is refused
    std::vector<encoder::can::CanFrame> to_bus;  ///< frames the host sends
  };

  /// Takes bytes from the host.
  Result on_bytes(std::span<const std::uint8_t> bytes);
  /// Takes a frame from the bus; returns nothing while the channel is closed.
  [[nodiscard]] std::vector<std::uint8_t> on_frame(const encoder::can::CanFrame& frame) const;
  /// The adapter loses power or is plugged in again: the channel is closed and has no bit rate.
  void reset() { *this = {}; }

  /// Error flags, kept until the host reads them: encoder::can::SlcanFlag.
  void set_flags(std::uint8_t flags) { flags_ = flags; }

 private:
  void on_line(Result& result);

  std::string line_;
  bool has_speed_ = false;
  bool open_ = false;
  std::uint8_t flags_ = 0;
};

}  // namespace curbstone::simulate::devices
