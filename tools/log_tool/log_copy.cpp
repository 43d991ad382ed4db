#include "tools/log_tool/log_copy.hpp"

#include <fmt/format.h>

#include "tools/output/new_file.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::log_tool {

void CopyOptions::declare(CommandLine& line) {
  line.option("log", logs, "LCM logs, or the folder of a session").required();
  line.option("--out", out, "The log to write").required();
  line.flag("--force", force, "Replace it if it is there");
}

LogLoss copy_log(const CopyOptions& options, const std::string& command,
                 const std::function<bool(const LogEvent&)>& wanted,
                 const std::function<void(LogWriter&, std::int64_t utime)>& head) {
  output::WatchedLog log(options.logs, "log " + command);
  output::NewFile file(options.out, options.force);
  std::int64_t all = 0;
  std::int64_t written = 0;
  {
    LogWriter writer(file.part());
    while (const auto event = log.next()) {
      ++all;
      if (!wanted(*event)) continue;
      if (written == 0 && head) head(writer, event->log_utime);
      writer.write(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()), event->log_utime);
      ++written;
    }
    writer.flush();
  }
  file.commit();
  fmt::print("{}: {} of {} messages\n", options.out, written, all);
  return log.files().loss();
}

}  // namespace curbstone::log_tool
