#include <limits>
#include <optional>
#include <stdexcept>

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
  const auto wanted = [&](const LogEvent& event) {
    if (!begin) {
      begin = event.log_utime;
      if (first && last && first->in_log(*begin) >= last->in_log(*begin))
        throw std::runtime_error("--from " + from + " is not before --to " + to);
    }
    return (!first || event.log_utime >= first->in_log(*begin)) && (!last || event.log_utime < last->in_log(*begin));
  };
  return copy_log(options, "cut", wanted).damaged() ? 1 : 0;
}

}  // namespace curbstone::log_tool
