#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace curbstone {

/// "no data for 2.3 s" as "no data for # s".
[[nodiscard]] std::string without_numbers(const std::string& text);

/// What a process writes to its log about the faults of SERVICE_STATUS: a line when one has come to stay, a line when
/// it is over, and nothing in between however long it lasts. Texts that differ only in their numbers are one fault. One
/// that comes and goes is written less and less often: every 10 s at most, then 20 s, up to 10 minutes.
class FaultLines {
 public:
  static constexpr std::int64_t kStays = 2'000'000;           ///< us; what a start passes through is no line
  static constexpr std::int64_t kFirstPause = 10'000'000;     ///< us
  static constexpr std::int64_t kLongestPause = 600'000'000;  ///< us; a fault that was away so long is a new one
  static constexpr std::size_t kMaxFaults = 64;               ///< remembered; the next ones are not written

  /// `faults`: all that hold now. `now`: us of a clock that does not jump. Returns the lines to write, without end of
  /// line. Call it about once a second.
  std::vector<std::string> update(const std::vector<std::string>& faults, std::int64_t now);

 private:
  struct Fault {
    std::string text;          // as it read last
    std::int64_t since = 0;    // holds since then
    std::int64_t held_at = 0;  // held last
    std::int64_t due = 0;      // not written before
    std::int64_t pause = kFirstPause;
    bool written = false;  // and not over since
  };
  void hold(const std::string& text, std::int64_t now);

  std::map<std::string, Fault> known_;  // by the text without its numbers
};

}  // namespace curbstone
