#include "procman/deputy/deputy_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/shell/status_reporter.hpp"

namespace curbstone::procman::deputy {

OwnConfig read_own_config(DeputyAppOptions& options) {
  OwnConfig own;
  config::Config& config = own.config;
  if (options.config_file.empty() && !options.allow_any) {
    throw UsageError("nothing to run: give --config FILE.cfg, or --allow-any to take orders for any command");
  }
  try {
    if (!options.config_file.empty()) config = config::load_config_file(options.config_file);
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
  std::set<std::string> deputies;
  for (const config::Command& command : config.commands) deputies.insert(command.deputy);
  if (options.id.empty()) options.id = deputies.size() == 1 ? *deputies.begin() : host_name();
  if (!config.commands.empty() && !deputies.contains(options.id)) {
    throw UsageError(fmt::format("{} has no command for deputy \"{}\", only for: {}; choose one with --id",
                                 options.config_file, options.id, fmt::join(deputies, ", ")));
  }
  const config::Script* start = config.find_script(options.script);
  if (!options.script.empty() && start == nullptr) {
    throw UsageError(fmt::format("{} has no script \"{}\"", options.config_file, options.script));
  }
  for (const config::Script& script : config.scripts) {
    const std::vector<std::string> errors = config::check_script(config, script);
    if (errors.empty()) continue;
    const std::string what = config::join_errors(options.config_file, errors);
    if (&script == start) throw UsageError(what);
    own.warnings.push_back(fmt::format("script \"{}\" cannot be run: {}", script.name, what));
  }
  std::erase_if(config.commands, [&](const config::Command& command) { return command.deputy != options.id; });
  if (!options.exit_when.empty() && config.find_command(options.exit_when) == nullptr) {
    throw UsageError(fmt::format("--exit-when {}: {} has no such command for deputy \"{}\"", options.exit_when,
                                 options.config_file, options.id));
  }
  return own;
}

}  // namespace curbstone::procman::deputy
