#include "tools/bench/mapping/bench_mapping.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/bench/mapping/mapping_report.hpp"
#include "tools/bench/mapping/poor_odometry.hpp"
#include "tools/bench/mapping/scan_drive.hpp"
#include "tools/bench/mapping/town_drive.hpp"

namespace curbstone {
namespace {

struct BenchMappingOptions {
  std::string recorded = "../shared/data/kitti0005_rs16";
  std::string scans, poses, times, json, tracks, sweep = "auto";
  std::vector<std::string> methods = mapping_methods();
  std::vector<std::string> priors = {"none", "poor", "ekf"};
  std::vector<std::string> set;
  std::size_t most = 1'000'000;
  double town_seconds = 40;
  std::uint64_t seed = 1;
};

/// One drive with every method, as its results come.
void run_all(const MappingDrive& drive, const BenchMappingOptions& options, std::vector<MappingResult>& results) {
  if (std::find(options.priors.begin(), options.priors.end(), drive.prior) == options.priors.end()) return;
  for (const std::string& method : options.methods) {
    results.push_back(run_mapping(drive, method, options.set));
    fmt::print("{}", mapping_line(results.back()));
    std::fflush(stdout);
    if (!options.tracks.empty()) write_mapping_track(results.back(), options.tracks);
  }
}

void run_scans(const BenchMappingOptions& options, const std::string& folder, const std::string& poses,
               std::vector<MappingResult>& results) {
  ScanDrive drive(folder, poses, options.times, options.most);
  if (options.sweep != "auto") drive.set_swept(options.sweep == "raw");
  run_all(drive, options, results);
  drive.prior = "poor";
  drive.add_odometry(poor_odometry(drive.truth(), {}, drive.period()));
  run_all(drive, options, results);
}

std::vector<MappingResult> run_drives(const BenchMappingOptions& options) {
  std::vector<MappingResult> results;
  fmt::print("{}", mapping_heading());
  if (!options.scans.empty()) {
    run_scans(options, options.scans, options.poses, results);
    return results;
  }
  if (std::filesystem::is_directory(options.recorded)) {
    run_scans(options, options.recorded, options.recorded + "/reference_poses.txt", results);
  } else {
    fmt::print("(no recorded drive in {}: left out)\n", options.recorded);
  }
  if (options.town_seconds > 0) {
    TownDrive town({options.seed, options.town_seconds});
    run_all(town, options, results);
    town.without_odometry();
    run_all(town, options, results);
  }
  return results;
}

void add_mapping_options(CLI::App& app, BenchMappingOptions& options) {
  app.add_option("--scans", options.scans, "Instead of the usual drives: folder of KITTI scans (*.bin), with --poses");
  app.add_option("--poses", options.poses, "Pose of each scan: 3x4 rows, lidar frame, to the first");
  app.add_option("--times", options.times, "Time of each scan, s; default: times.txt beside the poses, else 10 Hz");
  app.add_option("--sweep", options.sweep,
                 "Scans as the sensor swept them (raw), or put right for the motion (corrected)")
      ->check(CLI::IsMember({"auto", "raw", "corrected"}))
      ->capture_default_str();
  app.add_option("--recorded", options.recorded, "Folder of the recorded drive")->capture_default_str();
  app.add_option("--methods", options.methods, "Of: " + fmt::format("{}", fmt::join(mapping_methods(), ", ")))
      ->delimiter(',');
  app.add_option("--priors", options.priors, "Odometry: none, poor (2 % scale, 0.2 deg/s, of the truth), ekf (town)")
      ->delimiter(',')
      ->check(CLI::IsMember({"none", "poor", "ekf"}));
  app.add_option("--most", options.most, "Scans of a recorded drive, at most");
  app.add_option("--town-seconds", options.town_seconds, "Length of the simulated drive; 0: none")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Of the town")->capture_default_str();
  app.add_option("--set", options.set, "KEY=VALUE of section mapper, for our methods; repeatable");
  app.add_option("--tracks", options.tracks, "Write the poses of each run to this folder")
      ->check(CLI::ExistingDirectory);
  app.add_option("--json", options.json, "Write the figures to a file");
}

}  // namespace

int run_bench_mapping(int argc, char** argv) {
  BenchMappingOptions options;
  CLI::App app{"Poses and maps by every method, on the same drives"};
  app.name("curbstone bench mapping");
  add_mapping_options(app, options);
  try {
    app.parse(argc, argv);
    if (options.scans.empty() != options.poses.empty())
      throw CLI::ValidationError("--scans and --poses belong together");
    for (const std::string& method : options.methods) {
      const auto known = mapping_methods();
      if (std::find(known.begin(), known.end(), method) == known.end())
        throw CLI::ValidationError(fmt::format("--methods: nothing is called '{}'", method));
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const std::vector<MappingResult> results = run_drives(options);
    fmt::print("\n{}", mapping_maps(results));
    if (!options.json.empty()) write_mapping_json(results, options.json);
    return results.empty() ? 1 : 0;
  } catch (const ConfigError& error) {
    fmt::print(stderr, "curbstone bench mapping: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone bench mapping: {}\n", error.what());
    return 1;
  }
}

}  // namespace curbstone
