#pragma once

namespace curbstone::bench::localisation {

/// curbstone bench localisation: global localisation and the kidnapped-robot case, in a map.
int run_bench_localisation(int argc, char** argv);

}  // namespace curbstone::bench::localisation
