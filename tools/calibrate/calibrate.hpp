#pragma once

namespace curbstone::calibrate {

/// `curbstone calibrate LOG`: wheels and extrinsics from a drive. argv[0] is the subcommand's name. Returns the exit
/// status: 0 done, 1 input or output failed, 2 wrong usage.
int run_calibrate(int argc, char** argv);

}  // namespace curbstone::calibrate
