#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace curbstone::log_tool {

/// A time given by the user: seconds from the beginning of a log, "12.5", or UTC, "2026-11-23T20:52:00.5Z".
class LogTime {
 public:
  /// Throws std::runtime_error that names the option.
  LogTime(const std::string& text, const std::string& option);
  /// us since the Unix epoch, in a log that begins at `begin`.
  [[nodiscard]] std::int64_t in_log(std::int64_t begin) const { return relative_ ? begin + us_ : us_; }

 private:
  std::int64_t us_ = 0;
  bool relative_ = true;
};

/// "2026-11-23T20:52:00.500Z". For a time outside the years 1 to 9999, as a damaged log may have, the number itself.
[[nodiscard]] std::string utc_text(std::int64_t utime);

}  // namespace curbstone::log_tool
