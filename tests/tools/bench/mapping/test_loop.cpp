#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/temporary_folder.hpp"
#include "tools/bench/mapping/bench_mapping.hpp"
#include "tools/bench/mapping/loop_run.hpp"
#include "tools/command/run_subcommand.hpp"

namespace curbstone::bench::mapping {
namespace {

TEST(LoopDrive, KnowsWhenItComesBack) {
  const drives::LoopDrive same({.seed = 1, .loop = 1000}, 3);
  EXPECT_NEAR(same.returns(), same.lap() - drives::LoopDrive::kNear, 15);
  EXPECT_NEAR(same.length(), same.lap() + simulate::TownTour::kAgain, 1);
  const drives::LoopDrive opposite({.seed = 1, .loop = 1000, .opposite = true}, 3);
  EXPECT_NEAR(opposite.returns(), 100 + 1000 - drives::LoopDrive::kNear, 25) << "to where it turned into the loop";
  EXPECT_NEAR(opposite.length(), 1200, 30);
  const drives::LoopDrive part({.seed = 1, .seconds = 20, .loop = 1000}, 3);
  EXPECT_TRUE(std::isinf(part.returns()));
}

TEST(LoopRun, FollowsTheBeginningOfALoop) {
  const drives::LoopDrive drive({.seed = 2, .seconds = 8, .loop = 600}, 30);
  const LoopResult result = run_loop(drive, "icp", {});
  EXPECT_GT(result.run.revolutions, 90);
  EXPECT_EQ(result.run.poses, result.run.revolutions);
  EXPECT_NEAR(result.end.way_m, drive.length(), 0.2);
  EXPECT_LT(result.end.error_m, 0.1);
  EXPECT_GE(result.end.error_m, result.end.height_m);
  EXPECT_EQ(result.before.way_m, result.end.way_m) << "it has not come back";
  EXPECT_GT(result.odometry_end.error_m, 0.0);
  EXPECT_LT(result.odometry_end.percent(), 5.0);
  EXPECT_GT(result.mapping_cpu_s, 0.1);
  EXPECT_TRUE(result.laps.empty());

  const test::TemporaryFolder folder;
  const std::string file = folder / "bench_loop.json";
  write_loop_json({result}, file);
  std::ifstream in(file);
  const nlohmann::json run = nlohmann::json::parse(in)["runs"][0];
  for (const char* key : {"name", "method", "t_rel_percent", "end_percent", "way_m", "before_percent", "end_m"})
    EXPECT_TRUE(run.contains(key)) << key;
}

TEST(LoopRun, IsTheSameDriveEachTime) {
  const drives::LoopDrive drive({.seed = 2, .seconds = 1.5, .loop = 600}, 3);
  std::vector<std::size_t> points[2];
  for (auto& of_run : points)
    drive.play(
        [&](const mapper::scan::Scan& r, const mapper::scan::OdometryHistory&) { of_run.push_back(r.points.size()); });
  EXPECT_GT(points[0].size(), 5U);
  EXPECT_EQ(points[0], points[1]);
}

TEST(LoopCommand, RefusesWrongUse) {
  const auto bench = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "mapping");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    return command::run_subcommand("bench mapping", run_bench_mapping, static_cast<int>(argv.size()), argv.data());
  };
  EXPECT_EQ(bench({"--opposite"}), 2);
  EXPECT_EQ(bench({"--hours", "1"}), 2);
  EXPECT_EQ(bench({"--loop", "10"}), 2);
  EXPECT_EQ(bench({"--loop", "1000", "--opposite", "--hours", "1"}), 2);
}

}  // namespace
}  // namespace curbstone::bench::mapping
