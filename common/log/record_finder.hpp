#pragma once

#include <cstdint>
#include <optional>

#include "common/log/file_window.hpp"

namespace curbstone {

/// A record of a log: its position and its header. The header is the sync word 0xEDA1DA01, then big-endian the record
/// number (int64), its time (int64), the lengths of channel and data (int32). Format: lcm/lcm/eventlog.c.
struct LogRecord {
  static constexpr std::int64_t kHeader = 28;  ///< bytes

  std::int64_t begin = 0;   ///< bytes from the beginning of the file
  std::int64_t number = 0;  ///< counts up from 0
  std::int64_t utime = 0;   ///< us
  std::int64_t channel_size = 0;
  std::int64_t data_size = 0;
  [[nodiscard]] std::int64_t end() const { return begin + kHeader + channel_size + data_size; }

  /// The number of record numbers between this record's and that of `later`; 0 if a damaged number makes it negative or
  /// more than kMaxMissing.
  [[nodiscard]] std::int64_t missing_until(const LogRecord& later) const {
    const std::uint64_t steps = static_cast<std::uint64_t>(later.number) - static_cast<std::uint64_t>(number);
    return steps >= 1 && steps <= kMaxMissing ? static_cast<std::int64_t>(steps) - 1 : 0;
  }
  [[nodiscard]] bool is_followed_by(const LogRecord& next) const {
    return static_cast<std::uint64_t>(next.number) - static_cast<std::uint64_t>(number) == 1;
  }
  static constexpr std::uint64_t kMaxMissing = std::uint64_t{1} << 31;
};

/// Finds the records of a log, damaged or not. A record has no checksum; it is accepted if it is plausible by itself
/// and consistent with what follows it. One thread.
class RecordFinder {
 public:
  explicit RecordFinder(FileWindow& file) : file_(file) {}

  /// The record at `at`, where the previous one ended. If `previous` is given, a broken sync word is tolerated.
  [[nodiscard]] std::optional<LogRecord> record_at(std::int64_t at, const std::optional<LogRecord>& previous = {});
  /// The first record at or after `from`.
  [[nodiscard]] std::optional<LogRecord> first_from(std::int64_t from);
  /// Whether what each record begins with is at `at`.
  [[nodiscard]] bool is_sync_at(std::int64_t at);
  /// Whether a record begins at `at` and is cut off by the end of the file.
  [[nodiscard]] bool cut_off_at(std::int64_t at);

 private:
  [[nodiscard]] std::optional<LogRecord> header_at(std::int64_t at, bool any_sync);
  [[nodiscard]] bool ends_at_sync(const LogRecord& record);
  [[nodiscard]] bool fits_what_follows(const LogRecord& record);
  [[nodiscard]] std::optional<LogRecord> confirmed_from(std::int64_t from);

  FileWindow& file_;
  // The last result of confirmed_from() and where its search began. Without it a damaged file would be searched again
  // for each record.
  std::int64_t searched_from_ = -1;
  std::int64_t searched_to_ = -1;
  std::optional<LogRecord> confirmed_;
};

}  // namespace curbstone
