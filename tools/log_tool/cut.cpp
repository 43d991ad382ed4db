#include <limits>
#include <optional>
#include <stdexcept>

#include "services/recorder/config_cache.hpp"
#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/log_copy.hpp"
#include "tools/log_tool/log_time.hpp"

namespace curbstone::log_tool {

int run_cut(int argc, char** argv) {
  CopyOptions options;
  std::string from;
  std::string to;
  CommandLine line("The messages of a log from one time on and before another, by the times of their records",
                   "curbstone log cut");
  options.declare(line);
  line.option("--from", from, "Seconds from the beginning, or UTC (2026-11-23T20:52:00Z); default: the beginning");
  line.option("--to", to, "The same; default: the end");
  if (const auto status = line.read(argc, argv)) return *status;
  const auto first = from.empty() ? std::nullopt : std::optional(LogTime(from, "--from"));
  const auto last = to.empty() ? std::nullopt : std::optional(LogTime(to, "--to"));
  std::optional<std::int64_t> begin;
  // Each process publishes its CONFIG every 5 s: a part has those before it, as each file of a session does. Without
  // them its replay would be that of another vehicle.
  recorder::ConfigCache configs;
  const auto wanted = [&](const LogEvent& event) {
    if (!begin) {
      begin = event.log_utime;
      if (first && last && first->in_log(*begin) >= last->in_log(*begin))
        throw std::runtime_error("--from " + from + " is not before --to " + to);
    }
    const bool is_before = first && event.log_utime < first->in_log(*begin);
    if (is_before && event.channel == "CONFIG") configs.take(event.bytes.data(), static_cast<int>(event.bytes.size()));
    return !is_before && (!last || event.log_utime < last->in_log(*begin));
  };
  const auto head = [&](LogWriter& log, std::int64_t utime) { configs.write(log, utime); };
  return copy_log(options, "cut", wanted, head).damaged() ? 1 : 0;
}

}  // namespace curbstone::log_tool
