#include "tools/log_tool/channel_pattern.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace curbstone::log_tool {

ChannelPattern::ChannelPattern(const std::string& text) try : pattern_(text, std::regex::extended) {
} catch (const std::regex_error&) {
  throw std::runtime_error(fmt::format("--channels {}: is no regular expression", text));
}

bool ChannelPattern::fits(const std::string& channel) const {
  return std::regex_match(channel, pattern_);
}

}  // namespace curbstone::log_tool
