#pragma once

namespace curbstone::bench::mapping {

/// `curbstone bench mapping`: odometry and mapping with every method on recorded and simulated drives. Exit status as
/// of run_bench().
int run_bench_mapping(int argc, char** argv);

}  // namespace curbstone::bench::mapping
