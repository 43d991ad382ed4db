#include <fmt/format.h>

#include <array>
#include <exception>
#include <string_view>

#include "common/version.hpp"
#include "tools/bench/bench.hpp"
#include "tools/calibrate/calibrate.hpp"
#include "tools/detect/detect.hpp"
#include "tools/evaluate/evaluate.hpp"
#include "tools/export/export.hpp"
#include "tools/replay/replay.hpp"
#include "tools/simulate/simulate.hpp"

namespace {

struct Subcommand {
  std::string_view name;
  int (*run)(int argc, char** argv);
  std::string_view summary;
};

constexpr std::array kSubcommands = {
    Subcommand{"simulate", curbstone::run_simulate, "an emulated vehicle: sensor bytes or a log, and the truth"},
    Subcommand{"replay", curbstone::run_replay, "make a map from a log, as fast as the machine can"},
    Subcommand{"evaluate", curbstone::run_evaluate, "compare a map with the truth"},
    Subcommand{"detect", curbstone::run_detect, "curbs and classes of any cloud: .pcd, .ply, KITTI .bin"},
    Subcommand{"export", curbstone::run_export, "a map for others: nav2, QGIS, Lanelet2, GeoJSON, PCD, PLY"},
    Subcommand{"calibrate", curbstone::run_calibrate, "wheels and extrinsics from a drive"},
    Subcommand{"bench", curbstone::run_bench, "measure: speed and accuracy, beside the peers"},
};

int usage(std::FILE* out) {
  fmt::print(out, "usage: curbstone SUBCOMMAND [OPTIONS]   (curbstone SUBCOMMAND --help says more)\n\n");
  for (const auto& subcommand : kSubcommands) fmt::print(out, "  {:<10} {}\n", subcommand.name, subcommand.summary);
  return out == stdout ? 0 : 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return usage(stderr);
  const std::string_view name = argv[1];
  if (name == "--help" || name == "-h" || name == "help") return usage(stdout);
  if (name == "--version") {
    fmt::print("{}\n", curbstone::version());
    return 0;
  }
  for (const auto& subcommand : kSubcommands) {
    if (name != subcommand.name) continue;
    try {
      return subcommand.run(argc - 1, argv + 1);
    } catch (const std::exception& error) {
      fmt::print(stderr, "curbstone {}: {}\n", name, error.what());
      return 1;
    }
  }
  fmt::print(stderr, "curbstone: no subcommand '{}'\n", name);
  return usage(stderr);
}
