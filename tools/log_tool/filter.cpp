#include "tools/log_tool/channel_pattern.hpp"
#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/log_copy.hpp"

namespace curbstone::log_tool {

int run_filter(int argc, char** argv) {
  CopyOptions options;
  std::string channels;
  bool others = false;
  CommandLine line("Some channels of a log", "curbstone log filter");
  options.declare(line);
  line.option("--channels", channels, "Regular expression that fits the whole name: 'IMU|WHEELS', 'PM_.*'").required();
  line.flag("--not", others, "Write the others");
  if (const auto status = line.read(argc, argv)) return *status;
  const ChannelPattern pattern(channels);
  const auto wanted = [&](const LogEvent& event) { return pattern.fits(event.channel) != others; };
  return copy_log(options, "filter", wanted).damaged() ? 1 : 0;
}

}  // namespace curbstone::log_tool
