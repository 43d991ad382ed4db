#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "procman/config/config.hpp"
#include "procman/output/output_keeper.hpp"

namespace curbstone::procman::deputy {

/// Wrong options or config; what() is a message for the operator.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct DeputyAppOptions {
  std::string config_file;  ///< empty: none
  std::string id;           ///< empty: the only deputy that the config names, else the host name
  std::string script;       ///< script to run at the start
  bool start_all = false;
  bool allow_any = false;           ///< accept orders for commands that are not in the config
  bool allow_empty_orders = false;  ///< an order without commands removes all that are not in the config
  bool doctor = false;              ///< run `curbstone doctor` at the start
  bool quiet = false;               ///< do not print the commands' output
  std::string lcm_url;
  std::string log_dir;
  output::KeepLimits keep;
  std::string exit_when;  ///< when this command has ended, stop the others and exit
  double settle = 0;      ///< s between the end of `exit_when` and stopping the others
};

struct OwnConfig {
  config::Config config;              ///< this deputy's commands, and all scripts
  std::vector<std::string> warnings;  ///< which scripts cannot be run, and why
};

/// Reads the operator's file. Sets `options.id` if it is empty. Throws UsageError.
[[nodiscard]] OwnConfig read_own_config(DeputyAppOptions& options);

}  // namespace curbstone::procman::deputy
