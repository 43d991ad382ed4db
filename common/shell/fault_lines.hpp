#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace curbstone {

/// Replaces the numbers of a text: "no data for 2.3 s" becomes "no data for # s".
[[nodiscard]] std::string without_numbers(const std::string& text);

/// Turns the faults of SERVICE_STATUS into lines for the process's log: one line when a fault persists, one line when
/// it is over, and none in between. Texts that differ only in their numbers are one fault. A fault that comes and goes
/// is written less and less often: at most every 10 s, then every 20 s, up to 10 minutes.
class FaultLines {
 public:
  static constexpr std::int64_t kStays = 2'000'000;        ///< us; a shorter fault, as at a start, is not written
  static constexpr std::int64_t kFirstPause = 10'000'000;  ///< us
  static constexpr std::int64_t kMaxPause = 600'000'000;   ///< us; a fault that was absent this long is a new one
  static constexpr std::size_t kMaxFaults = 64;            ///< remembered; further ones are not written

  /// `faults`: all present faults. `now`: us of a steady clock. Returns the lines to write, without line ends. Call it
  /// about once a second.
  std::vector<std::string> update(const std::vector<std::string>& faults, std::int64_t now);

 private:
  struct Fault {
    std::string text;          // the latest text
    std::int64_t since = 0;    // holds since then
    std::int64_t held_at = 0;  // last seen
    std::int64_t due = 0;      // not written before this time
    std::int64_t pause = kFirstPause;
    bool written = false;  // its start was written and its end was not
  };
  void hold(const std::string& text, std::int64_t now);

  std::map<std::string, Fault> known_;  // by the text without its numbers
};

}  // namespace curbstone
