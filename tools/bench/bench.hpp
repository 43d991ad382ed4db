#pragma once

namespace curbstone::bench {

/// `curbstone bench NAME`: the measurements behind docs/benchmarks.md. argv[0] is the subcommand's name. Returns the
/// exit status: 0 done, 1 input or output failed, 2 wrong usage.
int run_bench(int argc, char** argv);

}  // namespace curbstone::bench
