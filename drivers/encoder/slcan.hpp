#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/counters.hpp"
#include "drivers/encoder/can_frame.hpp"

namespace curbstone {

// Lawicel's ASCII protocol: lines that end with CR. "t1812AABB" is a data frame with an 11-bit id (T: 29 bits), "r"/"R"
// a request; adapters answer a command by CR or, refusing, by BELL.

/// The frame of one line (without its CR); a time stamp of four more digits is tolerated. Empty if it is no frame.
[[nodiscard]] std::optional<CanFrame> parse_slcan_frame(std::string_view line);
[[nodiscard]] std::vector<std::uint8_t> encode_slcan(const CanFrame& frame);

/// Cuts the adapter's byte stream into frames and answers. There is no checksum: what is not exactly a frame is
/// refused. Only a frame whole and unspoilt at the end of a spoilt line is still read: no hexadecimal digit looks like
/// its first letter. Holds at most kMaxLine bytes.
///
/// Counts: slcan.frames, refused.slcan_line (malformed), refused.slcan_overlong.
class SlcanParser {
 public:
  enum class Answer { kOk, kRefused };
  struct Handlers {
    std::function<void(const CanFrame&)> on_frame;
    std::function<void(Answer)> on_answer;
  };
  static constexpr std::size_t kMaxLine = 64;

  void parse(std::span<const std::uint8_t> bytes, const Handlers& handlers);
  void reset() { line_.clear(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void on_line(const Handlers& handlers);

  std::string line_;
  bool overlong_ = false;
  Counters counters_;
};

}  // namespace curbstone
