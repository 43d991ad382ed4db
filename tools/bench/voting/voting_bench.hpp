#pragma once

namespace curbstone::bench::voting {

/// `curbstone bench voting`: tensor voting next to PCL's normals, relative to this machine's peak, and on a growing
/// map. argv[0] is the subcommand's name. Returns the exit status: 0 done, 1 input or output failed, 2 wrong usage.
int run_bench_voting(int argc, char** argv);

}  // namespace curbstone::bench::voting
