#pragma once

namespace curbstone::bench::faults {

/// curbstone bench faults: what is lost when processes die, hang or starve in a drive of the demo's processes.
int run_bench_faults(int argc, char** argv);

}  // namespace curbstone::bench::faults
