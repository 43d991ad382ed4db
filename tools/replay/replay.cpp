#include "tools/replay/replay.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/log/log_reader.hpp"
#include "tools/log/message_order.hpp"

namespace curbstone {

int run_replay(int argc, char** argv) {
  CLI::App app{"Makes a map from an lcm-logger log with the vehicle's own nodes, in message-time order"};
  std::string log;
  app.add_option("log", log, "Log of lcm-logger")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  LogReader reader(log);
  return 0;
}

}  // namespace curbstone
