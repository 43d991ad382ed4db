#pragma once

namespace curbstone::log_tool {

/// `curbstone log info|cut|join|repair|filter|csv|pcd`: inspects any LCM log, and makes new logs from it. argv[0] is
/// the subcommand's name.
int run_log(int argc, char** argv);

}  // namespace curbstone::log_tool
