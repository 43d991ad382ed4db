#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "common/config/command_line.hpp"
#include "tools/log_tool/channel_table.hpp"
#include "tools/log_tool/commands.hpp"
#include "tools/output/inputs.hpp"
#include "tools/output/new_file.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::log_tool {

namespace {

struct CsvOptions {
  std::vector<std::string> logs;
  std::string channel;
  std::string out;
  bool elements = false;
  bool force = false;
};

bool write_table(const CsvOptions& options, std::ostream& out) {
  output::WatchedLog log(options.logs, "log csv");
  ChannelTable table(out, options.elements);
  while (const auto event = log.next()) {
    if (event->channel == options.channel) table.write(*event);
    if (!out) break;
  }
  out.flush();
  if (!out && !options.out.empty())  // guard_standard_streams() says what is lost there
    throw std::runtime_error(fmt::format("{}: not written whole: is the disk full?", options.out));
  if (table.undecodable() > 0)
    fmt::print(stderr, "curbstone log csv: {} messages of {} have no known type, or another one than the first\n",
               table.undecodable(), options.channel);
  if (table.rows() == 0)
    throw std::runtime_error(fmt::format("no row: 'curbstone log info' lists the channels and their types"));
  if (!table.left_out().empty())
    fmt::print(stderr, "curbstone log csv: without the arrays {}{}\n", fmt::join(table.left_out(), ", "),
               options.elements ? "" : " (--elements: a row for each of their elements)");
  return log.damaged();
}

}  // namespace

int run_csv(int argc, char** argv) {
  CsvOptions options;
  CommandLine line("The fields of a channel as a table", "curbstone log csv");
  line.option("log", options.logs, "LCM logs, or the folder of a session").required();
  line.option("--channel", options.channel, "Whose messages").required();
  line.option("--out", options.out, "The file to write; default: the standard output");
  line.flag("--elements", options.elements, "A row for each element of the arrays of variable length: points, say");
  line.flag("--force", options.force, "Replace the file if it is there");
  if (const auto status = line.read(argc, argv)) return *status;
  if (options.out.empty()) return write_table(options, std::cout) ? 1 : 0;
  output::refuse_to_overwrite(LogFiles(options.logs).names(), options.out);
  output::NewFile file(options.out, options.force);
  std::ofstream out(file.part(), std::ios::binary);
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", options.out));
  const bool damaged = write_table(options, out);
  out.close();
  file.commit();
  return damaged ? 1 : 0;
}

}  // namespace curbstone::log_tool
