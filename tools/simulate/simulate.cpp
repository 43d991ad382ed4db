#include "tools/simulate/simulate.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "common/clock.hpp"
#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/town_surroundings.hpp"
#include "tools/simulate/truth/truth_folder.hpp"

namespace curbstone {

namespace {

struct Options {
  bool town = false;
  std::uint64_t seed = 1;
  double seconds = 60;
  std::string log, truth, config;
  std::vector<std::string> set;
  std::int64_t start_utime = 1'750'000'000'000'000;
};

int simulate_town(const Options& options, const SimulateConfig& config) {
  TownOptions town_options;
  town_options.seed = options.seed;
  const Town town(town_options);
  const SpeedProfile profile({config.speed, config.standstill, config.acceleration, 26.0, 2.5}, options.seconds);
  const TownMotion motion(town, config.vehicle, profile);
  TownSurroundings surroundings(town, config.lidar);
  const TruthInfo info{options.start_utime, options.seed, "town", options.seconds};
  if (!options.truth.empty()) {
    prepare_truth_folder(options.truth);
    write_poses(options.truth, info, motion);
    write_town_truth(options.truth, info, town, config.vehicle.height);
  }
  if (!options.log.empty()) {
    const auto begin = steady_clock();
    const Drive drive{motion, surroundings, config, options.seed, options.start_utime, options.seconds, config.rpm};
    const Recorded recorded = record_drive(drive, options.log);
    const double took = static_cast<double>(steady_clock() - begin) * 1e-6;
    fmt::print(
        "simulate: {:.1f} s, {:.1f} m, {} LiDAR packets, {} IMU and {} wheel samples in {} ({:.1f} x real time)\n",
        options.seconds, profile.distance(options.seconds), recorded.packets, recorded.imu, recorded.wheels,
        options.log, options.seconds / took);
  }
  return 0;
}

}  // namespace

int run_simulate(int argc, char** argv) {
  Options options;
  CLI::App app{"An emulated vehicle: what its sensors would send on a drive, and the truth about it"};
  app.name("curbstone simulate");
  app.add_flag("--town", options.town, "Drive round the block in a town made from the seed");
  app.add_option("--seed", options.seed, "Of the town and of all noise")->capture_default_str();
  app.add_option("--seconds", options.seconds, "Length of the drive")
      ->check(CLI::Range(0.1, 36000.0))
      ->capture_default_str();
  app.add_option("--log", options.log, "Write an LCM log, as fast as it goes");
  app.add_option("--truth", options.truth, "Folder for the true poses, classes and curbs");
  app.add_option("--config", options.config, "The vehicle's YAML file");
  app.add_option("--set", options.set, "KEY=VALUE of section simulate");
  app.add_option("--start-utime", options.start_utime, "us since the epoch, of the beginning (with --log)")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  ConfigOf<SimulateConfig> config;
  try {
    if (!options.config.empty()) load_config(options.config, "simulate", config);
    for (const auto& assignment : options.set) set_config_value(assignment, config);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "curbstone simulate: {}\n", error.what());
    return 2;
  }
  return simulate_town(options, config.value);
}

}  // namespace curbstone
