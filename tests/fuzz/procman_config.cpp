// A .cfg file of procman: read, checked, its exec lines split.
#include <optional>

#include "procman/config/config.hpp"
#include "procman/config/exec_line.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone::procman::config;
  using curbstone::fuzz::require;
  try {
    const Config config = parse_config(curbstone::fuzz::text({data, size}), "fuzz.cfg");
    const std::vector<std::string> errors = check_config(config);
    for (const Script& script : config.scripts) (void)check_script(config, script);
    for (const Command& command : config.commands) {
      require(command.stop_signal >= 1 && command.stop_signal <= 64, "a signal has a number of a signal");
      require(command.stop_time_allowed >= 0, "the time to stop is not negative");
      const ExecLine line =
          parse_exec_line(command.exec, [](const std::string&) { return std::optional<std::string>("x"); });
      require(!line.argv.empty() || !line.error.empty(), "an exec line can be executed, or says why not");
      require(!errors.empty() || line.error.empty(), "a file without errors has exec lines without errors");
    }
    std::size_t staged = 0;
    for (const auto& stage : config.stages()) staged += stage.size();
    require(!errors.empty() || staged == config.commands.size(), "each command is stopped in one stage");
  } catch (const ConfigSyntaxError& error) {
    require(error.line() >= 1 && error.column() >= 1, "an error has a place");
  }
  return 0;
}
