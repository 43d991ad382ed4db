#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "common/lcm_bus.hpp"
#include "common/version.hpp"
#include "procman/deputy_app.hpp"

int main(int argc, char** argv) {
  using namespace curbstone::procman;
  DeputyAppOptions options;
  CLI::App app{
      "Starts, watches, restarts and stops the processes of a procman .cfg, alone or as a sheriff orders.\n"
      "SIGINT or SIGTERM stops them group by group, in the order of the file; a second one kills them."};
  app.add_option("--config", options.config_file, "The commands, in procman's grammar");
  app.add_option("-i,--id", options.id, "Name as deputy; default: the only one in the config, else the host's");
  auto* script = app.add_option("--script", options.script, "Run this script of the config at the start");
  app.add_flag("--start-all", options.start_all, "Start all commands, the last of the file first")->excludes(script);
  app.add_option("--exit-when", options.exit_when, "When this command has ended, stop the others and exit");
  app.add_option("--settle", options.settle, "s to wait then, while what was lost on the way is asked for again")
      ->check(CLI::Range(0.0, 3600.0));
  app.add_flag("--allow-any", options.allow_any, "Take orders for commands that are not in the config");
  app.add_option(
      "-u,--lcm-url", options.lcm_url,
      "Bus for procman's own messages; default $LCM_DEFAULT_URL, else " + std::string(curbstone::LcmBus::kDefaultUrl));
  app.add_option("--log-dir", options.log_dir, "Keep all output here, one rotated file a command");
  app.add_option("--log-size", options.keep.file_bytes, "Bytes a log file may have")->capture_default_str();
  app.add_flag("-q,--quiet", options.quiet,
               "Print only what the deputy itself has to say, and the last words of the dead");
  app.set_version_flag("--version", curbstone::version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
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
