#include <fmt/format.h>

#include <vector>

#include "common/config/command_line.hpp"
#include "common/message_types/type_table.hpp"
#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/log_summary.hpp"
#include "tools/log_tool/log_time.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::log_tool {

namespace {

double us_to_seconds(std::int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

std::string type_names(const ChannelSummary& channel) {
  std::vector<std::string> names;
  for (const std::int64_t fingerprint : channel.fingerprints) {
    const MessageType* type = TypeTable::built_in().find(fingerprint);
    names.push_back(type != nullptr ? type->name
                                    : fmt::format("unknown ({:016x})", static_cast<std::uint64_t>(fingerprint)));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void print_summary(const LogSummary& summary, const LogFiles& files) {
  for (const std::string& name : files.names()) fmt::print("{}\n", name);
  fmt::print("begins {}, ends {}: {:.1f} s, {} messages\n\n", utc_text(summary.begin()), utc_text(summary.end()),
             us_to_seconds(summary.end() - summary.begin()), summary.messages());
  fmt::print("{:<20} {:>9} {:>8} {:>9} {:>10}  {}\n", "channel", "messages", "Hz", "MB", "longest gap", "type");
  for (const auto& [name, channel] : summary.channels()) {
    fmt::print("{:<20} {:>9} {:>8.1f} {:>9.2f} {:>9.2f} s  {}\n", name, channel.messages, channel.hz(),
               static_cast<double>(channel.bytes) * 1e-6, us_to_seconds(channel.longest_gap), type_names(channel));
  }
  fmt::print("\nconfiguration: {}\n", summary.configs().empty() ? "none is recorded" : "recorded of");
  for (const std::string& config : summary.configs()) fmt::print("  {}\n", config);
  for (const std::string& gap : summary.gaps()) fmt::print("nothing recorded: {}\n", gap);
  if (const std::string back = summary.back(); !back.empty())
    fmt::print("times go back by {}: two drives in one log, or a clock that was set\n", back);
  for (const std::string& note : files.notes()) fmt::print("{}\n", note);
}

}  // namespace

int run_info(int argc, char** argv) {
  std::vector<std::string> logs;
  CommandLine line("What is in a log: channels, types, rates, times, gaps, damage, configuration",
                   "curbstone log info");
  line.option("log", logs, "LCM logs, or the folder of a session").required();
  if (const auto status = line.read(argc, argv)) return *status;
  LogFiles files(logs);
  output::ProgressBar bar("log info");
  LogSummary summary;
  while (const auto event = files.next()) {
    summary.take(*event);
    bar.show(files.progress());
  }
  bar.clear();
  print_summary(summary, files);
  return files.loss().damaged() ? 1 : 0;
}

}  // namespace curbstone::log_tool
