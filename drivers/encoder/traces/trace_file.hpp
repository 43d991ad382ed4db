#pragma once

#include <cstdint>
#include <deque>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/traces/pcan_trace.hpp"

namespace curbstone::encoder::traces {

/// The frames of a recording of either kind. If it has several buses one is read: the bus of the first frame with one
/// of the given ids, or the first bus if no ids are given. Until it is known, the frames of all buses are returned.
///
/// Counts: refused.trace_line, ignored.trace_line (no classical frames), ignored.other_bus.
class TraceFile {
 public:
  struct Frame {
    std::int64_t utime = 0;  ///< us since the Unix epoch
    can::CanFrame frame;
  };

  /// Throws std::runtime_error with a one-line message if the file cannot be read, begins with 1000 lines that are none
  /// of a recording, is of an unsupported version, or has no times. `ours`: CAN ids, bit 31 marks a 29-bit id.
  explicit TraceFile(std::string path, std::vector<std::uint32_t> ours = {});

  /// The next frame; nothing at the end.
  std::optional<Frame> next();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[noreturn]] void fail(const std::string& why) const;
  bool read_from_file(std::string& text);
  bool read_line(std::string& text);
  std::optional<Frame> parse(const std::string& text);
  [[nodiscard]] bool is_ours(const can::CanFrame& frame) const;

  std::string path_;
  std::ifstream file_;
  std::deque<std::string> heading_;  // the file's first lines, until they are parsed
  int line_ = 0;                     // number of the line that was parsed last
  std::string first_refused_;        // for the error message
  bool pcan_ = false;
  PcanTrace trace_;
  std::vector<std::uint32_t> ours_;
  std::optional<std::string> bus_;
  std::optional<Frame> first_;
  Counters counters_;
};

}  // namespace curbstone::encoder::traces
