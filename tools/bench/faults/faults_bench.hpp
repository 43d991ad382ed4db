#pragma once

namespace curbstone::bench::faults {

/// curbstone bench faults: the losses when processes of the demo die, hang or starve during a drive.
int run_bench_faults(int argc, char** argv);

}  // namespace curbstone::bench::faults
