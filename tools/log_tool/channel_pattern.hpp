#pragma once

#include <regex>
#include <string>

namespace curbstone::log_tool {

/// The channels that an option --channels names: a regular expression (POSIX extended) that fits the whole name.
class ChannelPattern {
 public:
  /// Throws std::runtime_error if `text` is no regular expression.
  explicit ChannelPattern(const std::string& text);

  [[nodiscard]] bool fits(const std::string& channel) const;

 private:
  std::regex pattern_;
};

}  // namespace curbstone::log_tool
