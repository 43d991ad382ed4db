#pragma once

namespace curbstone::bench::sensor_faults {

/// curbstone bench sensor-faults: the map of a town, and what the services say, when a sensor is wrong.
int run_bench_sensor_faults(int argc, char** argv);

}  // namespace curbstone::bench::sensor_faults
