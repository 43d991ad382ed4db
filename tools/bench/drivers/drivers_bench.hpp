#pragma once

namespace curbstone::bench::drivers {

/// curbstone bench drivers: packets, bytes and frames per second of the drivers on one core.
int run_bench_drivers(int argc, char** argv);

}  // namespace curbstone::bench::drivers
