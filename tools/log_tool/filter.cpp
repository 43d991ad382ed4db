#include <fmt/format.h>

#include <regex>
#include <stdexcept>

#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/log_copy.hpp"

namespace curbstone::log_tool {

namespace {

std::regex channel_pattern(const std::string& text) {
  try {
    return std::regex(text, std::regex::extended);
  } catch (const std::regex_error&) {
    throw std::runtime_error(fmt::format("--channels {}: is no regular expression", text));
  }
}

}  // namespace

int run_filter(int argc, char** argv) {
  CopyOptions options;
  std::string channels;
  bool others = false;
  CommandLine line("Some channels of a log", "curbstone log filter");
  options.declare(line);
  line.option("--channels", channels, "Regular expression that fits the whole name: 'IMU|WHEELS', 'PM_.*'").required();
  line.flag("--not", others, "Write the others");
  if (const auto status = line.read(argc, argv)) return *status;
  const std::regex pattern = channel_pattern(channels);
  const auto wanted = [&](const LogEvent& event) { return std::regex_match(event.channel, pattern) != others; };
  return copy_log(options, "filter", wanted).damaged() ? 1 : 0;
}

}  // namespace curbstone::log_tool
