#pragma once

namespace curbstone::log_tool {

/// `curbstone log info|cut|join|repair|filter|csv|pcd`: looks into any LCM log, and makes others of it. argv[0] is the
/// subcommand's name.
int run_log(int argc, char** argv);

}  // namespace curbstone::log_tool
