#pragma once

namespace curbstone::bench::markings {

/// curbstone bench markings: precision, recall and lateral error of the road markings.
int run_bench_markings(int argc, char** argv);

}  // namespace curbstone::bench::markings
