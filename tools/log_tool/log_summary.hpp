#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/log/log_reader.hpp"

namespace curbstone::log_tool {

/// One channel of a log.
struct ChannelSummary {
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  std::int64_t first_utime = 0;  ///< us, of the records
  std::int64_t last_utime = 0;
  std::int64_t previous_utime = 0;      ///< us, of the newest record
  std::int64_t longest_gap = 0;         ///< us between two records
  std::int64_t farthest_back = 0;       ///< us from one record to the next
  std::set<std::int64_t> fingerprints;  ///< at most kMaxFingerprints
  static constexpr std::size_t kMaxFingerprints = 5;

  [[nodiscard]] double hz() const;
};

/// Statistics of a log, collected event by event.
class LogSummary {
 public:
  void take(const LogEvent& event);

  [[nodiscard]] const std::map<std::string, ChannelSummary>& channels() const { return channels_; }
  [[nodiscard]] std::int64_t begin() const { return begin_; }  ///< us, the earliest record
  [[nodiscard]] std::int64_t end() const { return end_; }
  [[nodiscard]] std::int64_t messages() const { return messages_; }
  /// Where no channel was recorded for a second or more, whatever the order of the records: "0.5 .. 12.1 s".
  [[nodiscard]] std::vector<std::string> gaps() const;
  /// Where the records of a channel go back in time by a second or more: "12.0 s (IMU, WHEELS)". Empty if nowhere.
  [[nodiscard]] std::string back() const;
  /// "ekf on ugv, version 0.2.0", for each process that published its configuration.
  [[nodiscard]] const std::set<std::string>& configs() const { return configs_; }

 private:
  static constexpr std::size_t kMaxGaps = 100;
  static constexpr std::size_t kMaxSpans = 10'000;  // damaged times may give one span per record
  void cover(std::int64_t utime);

  std::map<std::string, ChannelSummary> channels_;
  std::int64_t begin_ = 0;
  std::int64_t end_ = 0;
  std::int64_t messages_ = 0;
  std::map<std::int64_t, std::int64_t> spans_;  // us, from and to: runs of records less than a gap apart
  std::set<std::string> configs_;
};

}  // namespace curbstone::log_tool
