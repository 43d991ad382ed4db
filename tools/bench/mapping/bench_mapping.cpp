#include "tools/bench/mapping/bench_mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "tools/bench/mapping/drives/poor_odometry.hpp"
#include "tools/bench/mapping/drives/scan_drive.hpp"
#include "tools/bench/mapping/drives/town_drive.hpp"
#include "tools/bench/mapping/loop_run.hpp"
#include "tools/bench/mapping/mapping_report.hpp"
#include "tools/bench/mapping/methods/loam_cloud.hpp"
#include "tools/bench/mapping/methods/make_mapping_method.hpp"
#include "tools/export/cloud_writer.hpp"

namespace curbstone::bench::mapping {
namespace {

struct BenchMappingOptions {
  std::string recorded = "../shared/data/kitti0005_rs16";
  std::string scans, poses, times, json, tracks, clouds, sweep = "auto";
  std::vector<std::string> methods = methods::mapping_methods();
  std::vector<std::string> priors = {"none", "poor", "ekf"};
  std::vector<std::string> set;
  drives::ScanDrive::Selection selection;
  double town_seconds = 40;
  double town_lidar_from = 0;  // s
  std::vector<std::string> town_set;
  double sweep_seconds = 0;  // 0: from the times file
  std::vector<std::uint64_t> seeds = {1};
  double loop = 0;  // m; 0: the standard drives
  bool opposite = false;
  double hours = 0;  // duration of a loop drive; 0: one lap
  double slips = 3;  // per minute
};

/// Writes the map that LOAM itself would keep of the drive, for the paper's table of sizes.
void write_loam_cloud(const drives::MappingDrive& drive, const methods::LoamCloud& cloud, const std::string& folder) {
  const std::string file = fmt::format("{}/{}-{}-loam.pcd", folder, drive.name, drive.prior);
  map_export::write_cloud(cloud.cloud(), map_export::CloudFormat::kPcd, file);
  fmt::print("{}: {} edges, {} planes, {} bytes\n", file, cloud.edges(), cloud.planes(),
             std::filesystem::file_size(file));
}

/// Runs one drive with every method, and prints each result at once.
void run_all(const drives::MappingDrive& drive, const BenchMappingOptions& options,
             std::vector<MappingResult>& results) {
  if (std::find(options.priors.begin(), options.priors.end(), drive.prior) == options.priors.end()) return;
  for (const std::string& method : options.methods) {
    methods::LoamCloud cloud(drive.vehicle);
    const bool keeps = method == "loam" && !options.clouds.empty();
    results.push_back(run_mapping(drive, method, options.set, [&](const MappingMoment& moment) {
      if (keeps && moment.pose) cloud.add(*moment.scan, *moment.pose);
    }));
    fmt::print("{}", mapping_line(results.back()));
    if (keeps) write_loam_cloud(drive, cloud, options.clouds);
    std::fflush(stdout);
    if (!options.tracks.empty()) write_mapping_track(results.back(), options.tracks);
  }
}

void run_scans(const BenchMappingOptions& options, const std::string& folder, const std::string& poses,
               std::vector<MappingResult>& results) {
  drives::ScanDrive drive(folder, poses, options.times, options.selection);
  if (options.sweep != "auto") drive.set_swept(options.sweep == "raw");
  if (options.sweep_seconds > 0) drive.set_sweep(options.sweep_seconds);
  run_all(drive, options, results);
  drive.prior = "poor";
  drive.add_odometry(drives::poor_odometry(drive.truth(), {}, drive.period()));
  run_all(drive, options, results);
}

std::vector<MappingResult> run_drives(const BenchMappingOptions& options) {
  ConfigOf<simulate::rig::SimulateConfig> config;
  for (const std::string& setting : options.town_set) set_config_value(setting, config);
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
  for (const std::uint64_t seed : options.seeds) {
    if (options.town_seconds == 0) break;
    drives::TownDrive town({seed, options.town_seconds, options.town_lidar_from, config.value});
    run_all(town, options, results);
    town.without_odometry();
    run_all(town, options, results);
  }
  return results;
}

void run_loops(const BenchMappingOptions& options) {
  std::vector<LoopResult> results;
  fmt::print("{}", loop_heading());
  for (const std::uint64_t seed : options.seeds) {
    const drives::LoopDrive drive(
        {.seed = seed, .seconds = 3600.0 * options.hours, .loop = options.loop, .opposite = options.opposite},
        options.slips);
    for (const std::string& method : options.methods) {
      results.push_back(run_loop(drive, method, options.set, [](const LapFigures& lap) {
        fmt::print("{}", lap_line(lap));
        std::fflush(stdout);
      }));
      fmt::print("{}", loop_line(results.back()));
      std::fflush(stdout);
      if (!options.tracks.empty()) write_mapping_track(results.back().run, options.tracks);
    }
  }
  if (!options.json.empty()) write_loop_json(results, options.json);
}

void add_mapping_options(CommandLine& line, BenchMappingOptions& options) {
  line.option("--scans", options.scans, "Instead of the usual drives: folder of KITTI scans (*.bin), with --poses");
  line.option("--poses", options.poses, "Pose of each scan: 3x4 rows, lidar frame, to the first");
  line.option("--times", options.times, "Time of each scan, s; default: times.txt beside the poses, else 10 Hz");
  line.option("--sweep", options.sweep, "Scans as the sensor swept them (raw), or put right for the motion (corrected)")
      .one_of({"auto", "raw", "corrected"})
      .shows_default();
  line.option("--recorded", options.recorded, "Folder of the recorded drive").shows_default();
  line.option("--methods", options.methods, "Of: " + fmt::format("{}", fmt::join(methods::mapping_methods(), ", ")))
      .comma_separated();
  line.option("--priors", options.priors, "Odometry: none, poor (2 % scale, 0.2 deg/s, of the truth), ekf (town)")
      .comma_separated()
      .one_of({"none", "poor", "ekf"});
  line.option("--sweep-seconds", options.sweep_seconds,
              "How long a raw scan took; 0: as long as scans are apart, at most 0.1 s")
      .within(0.0, 1.0)
      .shows_default();
  line.option("--first", options.selection.first, "Scan that a recorded drive begins with");
  line.option("--every", options.selection.every, "Takes one scan in so many: a faster vehicle").within(1, 1000);
  line.option("--most", options.selection.most, "Scans of a recorded drive, at most");
  line.option("--town-seconds", options.town_seconds, "Length of the simulated drive; 0: none")
      .within(0.0, 3600.0)
      .shows_default();
  line.option("--town-set", options.town_set,
              "KEY=VALUE of section simulate, for the town: speed=12 standstill=0 rpm=600; repeatable");
  line.option("--town-lidar-from", options.town_lidar_from, "s that the LiDAR of the town's drive is switched on late")
      .within(0.0, 3600.0);
  line.option("--seed", options.seeds, "Of the town; several, with commas, for several towns").comma_separated();
  line.option("--loop", options.loop, "Instead of the usual drives: once round several blocks of a town, m")
      .within(600.0, 4000.0);
  line.flag("--opposite", options.opposite, "With --loop: comes back to its first street the other way");
  line.option("--hours", options.hours, "With --loop: round and round, for so long; memory after each lap")
      .within(0.01, 100.0);
  line.option("--slips", options.slips, "With --loop: slip events of the wheels, a minute")
      .within(0.0, 60.0)
      .shows_default();
  line.option("--set", options.set, "KEY=VALUE of section mapper, for our methods; repeatable");
  line.option("--tracks", options.tracks, "Write the poses of each run to this folder").existing_folder();
  line.option("--clouds", options.clouds,
              "With method loam: write the features that LOAM itself keeps, as PCD, to this folder")
      .existing_folder();
  line.option("--json", options.json, "Write the figures to a file");
}

}  // namespace

int run_bench_mapping(int argc, char** argv) {
  BenchMappingOptions options;
  CommandLine line("Poses and maps by every method, on the same drives", "curbstone bench mapping");
  add_mapping_options(line, options);
  if (const auto status = line.read(argc, argv)) return *status;
  if (options.scans.empty() != options.poses.empty()) return line.refuse("--scans and --poses belong together");
  const bool round = options.opposite || options.hours > 0;
  if (round && options.loop == 0) return line.refuse("--opposite and --hours belong to --loop");
  if (options.opposite && options.hours > 0) return line.refuse("--opposite goes once round: no --hours");
  if (options.loop > 0 && !line.given("--methods")) options.methods = {"icp"};
  for (const std::string& method : options.methods) {
    const auto known = methods::mapping_methods();
    if (std::find(known.begin(), known.end(), method) == known.end())
      return line.refuse(fmt::format("--methods: nothing is called '{}'", method));
  }
  if (options.loop > 0) {
    run_loops(options);
    return 0;
  }
  const std::vector<MappingResult> results = run_drives(options);
  fmt::print("\n{}", mapping_maps(results));
  if (!options.json.empty()) write_mapping_json(results, options.json);
  return results.empty() ? 1 : 0;
}

}  // namespace curbstone::bench::mapping
