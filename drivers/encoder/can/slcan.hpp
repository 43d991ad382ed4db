#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::can {

// SLCAN, Lawicel's ASCII protocol (CANUSB manual): lines that end with CR. "t1812AABB" is a data frame with an 11-bit
// id (T: 29 bits), "r"/"R" a remote request. An adapter answers a command with CR, or refuses it with BELL. "F" reads
// and clears its error flags: the answer is "F" and two digits.

/// The bits of the answer to "F" (those of the SJA1000 controller).
enum SlcanFlag : std::uint8_t {
  kReceiveFull = 0x01,
  kTransmitFull = 0x02,
  kErrorWarning = 0x04,
  kDataOverrun = 0x08,
  kErrorPassive = 0x20,
  kArbitrationLost = 0x40,  ///< no error: other nodes had priority
  kBusError = 0x80,
};

/// Parses a line without its CR. Four more digits, a time stamp, are ignored. Empty if the line is not a frame.
[[nodiscard]] std::optional<CanFrame> parse_slcan_frame(std::string_view line);
/// Whether a line without its CR is a frame of CAN FD.
[[nodiscard]] bool is_slcan_fd(std::string_view line);
[[nodiscard]] std::vector<std::uint8_t> encode_slcan(const CanFrame& frame);

/// Splits the adapter's byte stream into frames and answers. The protocol has no checksum: a line that is not exactly a
/// frame is refused. A complete frame at the end of a damaged line is still read, because its first letter is not a
/// hexadecimal digit. Holds at most kMaxLine bytes. Pure.
///
/// Counts: slcan.frames, ignored.slcan_fd (CAN FD), refused.slcan_line (malformed), refused.slcan_overlong.
class SlcanParser {
 public:
  enum class Answer { kOk, kRefused };
  struct Handlers {
    std::function<void(const CanFrame&)> on_frame;
    std::function<void(Answer)> on_answer;
    std::function<void(std::uint8_t)> on_flags = {};         ///< the answer to "F"
    std::function<void(const char* cause)> on_refused = {};  ///< the counter's name
  };
  static constexpr std::size_t kMaxLine = 160;  ///< a frame of CAN FD has 146 and a time stamp

  void parse(std::span<const std::uint8_t> bytes, const Handlers& handlers);
  void reset() { line_.clear(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void on_line(const Handlers& handlers);

  std::string line_;
  bool overlong_ = false;
  Counters counters_;
};

}  // namespace curbstone::encoder::can
