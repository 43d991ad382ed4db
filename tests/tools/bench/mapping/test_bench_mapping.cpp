#include "tools/bench/mapping/bench_mapping.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/bench/mapping/drives/poor_odometry.hpp"
#include "tools/bench/mapping/drives/scan_drive.hpp"
#include "tools/bench/mapping/drives/town_drive.hpp"
#include "tools/bench/mapping/mapping_run.hpp"
#include "tools/command/run_subcommand.hpp"

namespace curbstone::bench::mapping {
namespace {

const std::string kRecorded = test::data_path("kitti0005_rs16");

bool has_recorded() {
  return std::filesystem::is_directory(kRecorded);
}

int bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "mapping");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return command::run_subcommand("bench mapping", run_bench_mapping, static_cast<int>(argv.size()), argv.data());
}

/// 72 m of a real street on ten beams, the LiDAR alone: what the best of the peers reach is a t_rel of 0.23 to 0.31 %
/// (docs/benchmarks/mapping.md).
TEST(BenchMapping, IcpFollowsARecordedStreetByTheLidarAlone) {
  if (!has_recorded()) GTEST_SKIP() << kRecorded << " is not there";
  const drives::ScanDrive drive(kRecorded, kRecorded + "/reference_poses.txt", "");
  const MappingResult result = run_mapping(drive, "icp", {});
  EXPECT_EQ(result.poses, 154);
  EXPECT_LT(result.errors.rpe_percent, 0.22);
  EXPECT_LT(result.errors.rpe_deg_per_m, 0.005);
  EXPECT_LT(result.errors.ate_m, 0.03);
  EXPECT_LT(result.nees.all, 6) << "the covariance is overconfident";
  EXPECT_GT(result.nees.all, 0.5) << "hardly a claim";
  EXPECT_LT(result.errors.end_percent, 0.2);
}

TEST(BenchMapping, IcpFollowsItWithAPoorPrior) {
  if (!has_recorded()) GTEST_SKIP() << kRecorded << " is not there";
  drives::ScanDrive drive(kRecorded, kRecorded + "/reference_poses.txt", "");
  drive.add_odometry(drives::poor_odometry(drive.truth(), {}, drive.period()));
  const MappingResult result = run_mapping(drive, "icp", {});
  EXPECT_LT(result.errors.rpe_percent, 0.2);
  EXPECT_LT(result.errors.rpe_deg_per_m, 0.005);
  EXPECT_LT(result.errors.ate_m, 0.03);
  EXPECT_LT(result.nees.all, 6) << "the covariance is overconfident";
  EXPECT_GT(result.nees.all, 0.5) << "hardly a claim";
  EXPECT_LT(result.errors.end_percent, 0.15);
}

/// A-LOAM has a t_rel of 0.49 % there.
TEST(BenchMapping, LoamFollowsItByTheLidarAlone) {
  if (!has_recorded()) GTEST_SKIP() << kRecorded << " is not there";
  const drives::ScanDrive drive(kRecorded, kRecorded + "/reference_poses.txt", "");
  const MappingResult result = run_mapping(drive, "loam", {});
  EXPECT_EQ(result.poses, 154);
  EXPECT_LT(result.errors.rpe_percent, 0.3);
  EXPECT_LT(result.errors.rpe_deg_per_m, 0.01);
  EXPECT_LT(result.errors.ate_m, 0.05);
  EXPECT_LT(result.nees.all, 6);
}

TEST(BenchMapping, BothMethodsFollowADriveThroughTheTown) {
  const drives::TownDrive drive({.seconds = 8});
  for (const char* method : {"icp", "loam"}) {
    const MappingResult result = run_mapping(drive, method, {});
    EXPECT_GT(result.revolutions, 90);
    EXPECT_EQ(result.poses, result.revolutions);
    EXPECT_GT(result.errors.distance_m, 3);
    EXPECT_LT(result.errors.ate_m, 0.02) << method;
  }
}

/// The same street at two to five times the speed, with a moving start.
TEST(BenchMapping, FollowsAFastVehicleByTheLidarAlone) {
  if (!has_recorded()) GTEST_SKIP() << kRecorded << " is not there";
  for (const std::size_t every : {2U, 3U, 4U, 5U}) {
    const drives::ScanDrive drive(kRecorded, kRecorded + "/reference_poses.txt", "", {.first = 1, .every = every});
    for (const char* method : {"icp", "loam"}) {
      const MappingResult result = run_mapping(drive, method, {});
      EXPECT_LT(result.errors.rpe_percent, 0.6) << method << ", every " << every;
      EXPECT_LT(result.errors.end_percent, 0.8) << method << ", every " << every;
    }
  }
}

TEST(BenchMapping, FollowsATownAtTwelveMetresASecondByALidarThatIsSwitchedOnLate) {
  simulate::rig::SimulateConfig config;
  config.rpm = 600;
  config.speed = 12;
  config.acceleration = 3;
  config.standstill = 0;
  drives::TownDrive drive({.seconds = 12, .lidar_from = 6, .config = config});
  drive.without_odometry();
  for (const char* method : {"icp", "loam"}) {
    const MappingResult result = run_mapping(drive, method, {});
    EXPECT_GT(result.errors.distance_m, 60);
    EXPECT_LT(result.errors.end_percent, 0.3) << method;
  }
}

TEST(BenchMapping, WritesTheFiguresOfEachRun) {
  if (!has_recorded()) GTEST_SKIP() << kRecorded << " is not there";
  const test::TemporaryFolder folder;
  const std::string file = folder / "bench_mapping.json";
  ASSERT_EQ(bench({"--scans", kRecorded, "--poses", kRecorded + "/reference_poses.txt", "--most", "12", "--methods",
                   "icp", "--json", file}),
            0);
  std::ifstream in(file);
  const nlohmann::json json = nlohmann::json::parse(in);
  ASSERT_EQ(json["runs"].size(), 2U);
  EXPECT_EQ(json["runs"][0]["name"], "kitti0005_rs16");
  EXPECT_EQ(json["runs"][0]["method"], "icp");
  EXPECT_EQ(json["runs"][0]["prior"], "none");
  EXPECT_EQ(json["runs"][1]["prior"], "poor");
  for (const nlohmann::json& run : json["runs"]) {
    EXPECT_EQ(run.size(), 18U);
    for (const char* key : {"t_rel_percent", "r_rel_deg_per_m", "ate_m", "end_percent", "ms_median", "ms_p95", "ms_max",
                            "nees", "nees_translation", "nees_rotation"}) {
      EXPECT_GT(run[key].get<double>(), 0) << key;
    }
    EXPECT_TRUE(run["memory_mb"].is_number());
  }
}

TEST(BenchMapping, RefusesWrongUse) {
  EXPECT_EQ(bench({"--methods", "magic"}), 2);
  EXPECT_EQ(bench({"--scans", "/tmp"}), 2);
  EXPECT_EQ(bench({"--scans", "/nowhere", "--poses", "/nowhere"}), 1);
  EXPECT_EQ(bench({"--every", "0"}), 2);
  EXPECT_EQ(bench({"--town-set", "speed=fast"}), 2);
}

}  // namespace
}  // namespace curbstone::bench::mapping
