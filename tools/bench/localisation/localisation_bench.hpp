#pragma once

namespace curbstone::bench::localisation {

/// curbstone bench localisation: a vehicle of which nothing is known, and one that is carried away, found in a map.
int run_bench_localisation(int argc, char** argv);

}  // namespace curbstone::bench::localisation
