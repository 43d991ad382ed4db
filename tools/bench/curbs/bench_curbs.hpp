#pragma once

namespace curbstone::bench::curbs {

/// `curbstone bench curbs`: precision, recall and lateral error of the curbs, on exact truth and on a labelled street.
/// argv[0] is the subcommand's name. Returns the exit status: 0 done, 1 input or output failed, 2 wrong usage.
int run_bench_curbs(int argc, char** argv);

}  // namespace curbstone::bench::curbs
