#pragma once

namespace curbstone::detect {

/// `curbstone detect CLOUD`: the method on any cloud. argv[0] is the subcommand's name. Returns the exit status: 0
/// done, 1 input or output failed (one line of error, no partial output), 2 wrong usage.
int run_detect(int argc, char** argv);

}  // namespace curbstone::detect
