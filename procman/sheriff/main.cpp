#include <fmt/format.h>

#include <exception>

#include "common/config/command_line.hpp"
#include "procman/sheriff/sheriff_app.hpp"

int main(int argc, char** argv) {
  using namespace curbstone::procman::sheriff;
  SheriffAppOptions options;
  curbstone::CommandLine line(
      "Shows what the deputies run, and starts and stops it. Without an action: a live table; once, when it is piped.\n"
      "Exit status: 0 done, 1 an order failed or took too long, 2 wrong usage, 3 no deputy, 4 another sheriff "
      "commands.");
  line.choice("action", options.action,
              {{"watch", Action::kWatch},
               {"status", Action::kStatus},
               {"start", Action::kStart},
               {"stop", Action::kStop},
               {"restart", Action::kRestart},
               {"run", Action::kRun},
               {"tail", Action::kTail}},
              "watch, status, start, stop, restart, run or tail");
  line.option("names", options.names, "Commands, groups or \"everything\"; for run: one script of --config");
  line.option("--config", options.config_file, "The file whose script is run, in procman's grammar");
  line.option("--wait", options.wait, "s that an order may take before the exit status says that it failed")
      .within(0.1, 86400.0)
      .shows_default();
  line.flag("--observe", options.observe, "Send nothing at all: only watch, status and tail");
  line.option("-u,--lcm-url", options.lcm_url, "Bus of the deputies");
  if (const auto status = line.read(argc, argv)) return *status;
  const bool orders = options.action == Action::kStart || options.action == Action::kStop ||
                      options.action == Action::kRestart || options.action == Action::kRun;
  if (orders && options.observe) return line.refuse("an observer gives no orders");
  if (orders && options.names.empty()) return line.refuse("say which commands or groups, or \"everything\"");
  if (options.action == Action::kRun && (options.names.size() != 1 || options.config_file.empty()))
    return line.refuse("run takes one script, and --config");
  try {
    return SheriffApp(options).run();
  } catch (const UnknownName& error) {
    fmt::print(stderr, "curbstone-sheriff: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone-sheriff: {}\n", error.what());
    return 1;
  }
}
