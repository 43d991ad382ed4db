#include "tools/bench/bench.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "tools/bench/curbs/bench_curbs.hpp"
#include "tools/bench/drivers/drivers_bench.hpp"
#include "tools/bench/faults/faults_bench.hpp"
#include "tools/bench/latency/latency_bench.hpp"
#include "tools/bench/localisation/localisation_bench.hpp"
#include "tools/bench/mapping/bench_mapping.hpp"
#include "tools/bench/markings/bench_markings.hpp"
#include "tools/bench/sensor_faults/sensor_faults_bench.hpp"
#include "tools/bench/viewer/viewer_bench.hpp"
#include "tools/bench/voting/voting_bench.hpp"
#include "tools/command/run_subcommand.hpp"

namespace curbstone::bench {

namespace {

struct Benchmark {
  std::string_view name;
  int (*run)(int argc, char** argv);
  std::string_view summary;
};

// One line per benchmark; each is a library in its own folder.
const std::vector<Benchmark> kBenchmarks = {
    {"voting", voting::run_bench_voting, "tensor voting: beside PCL, against this machine's peak, on a growing map"},
    {"mapping", mapping::run_bench_mapping, "odometry and mapping: icp, loam and PCL's methods on the same drives"},
    {"curbs", curbs::run_bench_curbs, "precision, recall and lateral error of the curbs"},
    {"markings", markings::run_bench_markings, "precision, recall, lateral error and types of the road markings"},
    {"latency", latency::run_bench_latency,
     "from the last packet of a revolution to the changed tiles, stage by stage"},
    {"localisation", localisation::run_bench_localisation, "a vehicle of which nothing is known, found in a saved map"},
    {"drivers", drivers::run_bench_drivers, "packets, bytes and frames a second of the drivers on one core"},
    {"faults", faults::run_bench_faults, "what is lost when processes die, hang or starve in a drive"},
    {"sensor-faults", sensor_faults::run_bench_sensor_faults,
     "the map of a town, and what the services say, when a sensor is wrong"},
    {"viewer", viewer::run_bench_viewer, "what a page of the live map costs, and how soon and how often it draws"},
};

int usage(std::FILE* out) {
  fmt::print(out, "usage: curbstone bench NAME [OPTIONS]   (curbstone bench NAME --help says more)\n\n");
  for (const auto& benchmark : kBenchmarks) fmt::print(out, "  {:<13} {}\n", benchmark.name, benchmark.summary);
  return out == stdout ? 0 : 2;
}

}  // namespace

int run_bench(int argc, char** argv) {
  if (argc < 2) return usage(stderr);
  const std::string_view name = argv[1];
  if (name == "--help" || name == "-h") return usage(stdout);
  for (const auto& benchmark : kBenchmarks) {
    if (name == benchmark.name)
      return command::run_subcommand(fmt::format("bench {}", name), benchmark.run, argc - 1, argv + 1);
  }
  fmt::print(stderr, "curbstone bench: nothing is called '{}'\n", name);
  return usage(stderr);
}

}  // namespace curbstone::bench
