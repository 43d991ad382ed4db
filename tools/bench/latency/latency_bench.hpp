#pragma once

namespace curbstone::bench::latency {

/// curbstone bench latency: from the last packet of a revolution to the changed tiles on the bus, stage by stage.
int run_bench_latency(int argc, char** argv);

}  // namespace curbstone::bench::latency
