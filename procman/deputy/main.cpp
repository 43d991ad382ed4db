#include <fmt/format.h>

#include <exception>

#include "common/bus/lcm_bus.hpp"
#include "common/config/command_line.hpp"
#include "procman/deputy/deputy_app.hpp"

int main(int argc, char** argv) {
  using namespace curbstone::procman::deputy;
  DeputyAppOptions options;
  curbstone::CommandLine line(
      "Starts, watches, restarts and stops the processes of a procman .cfg, alone or as a sheriff orders.\n"
      "SIGINT or SIGTERM stops them group by group, in the order of the file; a second one kills them.");
  line.option("--config", options.config_file, "The commands, in procman's grammar");
  line.option("-i,--id", options.id, "Name as deputy; default: the only one in the config, else the host's");
  const auto script = line.option("--script", options.script, "Run this script of the config at the start");
  line.flag("--start-all", options.start_all, "Start all commands, the last of the file first").excludes(script);
  line.option("--exit-when", options.exit_when, "When this command has ended, stop the others and exit");
  line.option("--settle", options.settle, "s to wait then, while what was lost on the way is asked for again")
      .within(0.0, 3600.0);
  line.flag("--allow-any", options.allow_any, "Take orders for commands that are not in the config");
  line.flag("--allow-empty-orders", options.allow_empty_orders,
            "Obey an order that names no command, which removes those that are not in the config");
  line.option(
      "-u,--lcm-url", options.lcm_url,
      "Bus for procman's own messages; default $LCM_DEFAULT_URL, else " + std::string(curbstone::LcmBus::kDefaultUrl));
  line.option("--log-dir", options.log_dir, "Keep all output here, one rotated file a command");
  line.option("--log-size", options.keep.file_bytes, "Bytes a log file may have").shows_default();
  line.flag("--doctor", options.doctor, "Run `curbstone doctor` at the start: what it finds is logged, and a fault");
  line.flag("-q,--quiet", options.quiet,
            "Print only what the deputy itself has to say, and the last words of the dead");
  if (const auto status = line.read(argc, argv)) return *status;
  try {
    return DeputyApp(options).run();
  } catch (const UsageError& error) {
    fmt::print(stderr, "curbstone-deputy: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone-deputy: {}\n", error.what());
    return 1;
  }
}
