#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "services/tensor_voting/voting/batch_voting.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/bench/timing/interleaved_timing.hpp"
#include "tools/bench/voting/batch_comparison.hpp"
#include "tools/bench/voting/fma_peak.hpp"
#include "tools/bench/voting/inputs/street_cloud.hpp"
#include "tools/bench/voting/pair_count.hpp"
#include "tools/bench/voting/pcl_normals.hpp"
#include "tools/bench/voting/voting_bench.hpp"
#include "tools/command/run_subcommand.hpp"

namespace curbstone::bench {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(StreetCloud, HasTheSurfacesOfThePeersCloudByTheirAreas) {
  const auto cloud = voting::inputs::street_cloud(100'000);
  const auto share = [&](auto belongs) {
    return static_cast<double>(std::count_if(cloud.begin(), cloud.end(), belongs)) / 100'000;
  };
  EXPECT_NEAR(share([](const auto& p) { return std::abs(p.y()) < 3.4 && std::abs(p.z()) < 0.05; }), 136.0 / 446, 0.01);
  EXPECT_NEAR(share([](const auto& p) { return std::abs(p.y()) > 8.95 && p.z() > 0.2; }), 20 * 2 * 1.8 / 446, 0.01);
  EXPECT_NEAR(share([](const auto& p) { return std::abs(p.x()) < 5; }), 0.5, 0.01);
  EXPECT_EQ(cloud, voting::inputs::street_cloud(100'000)) << "one seed, one cloud";
}

TEST(PairCount, IsThatOfAllPairsComparedOneByOne) {
  const auto cloud = voting::inputs::street_cloud(1500, 5, 3);
  std::int64_t expected = 0;
  for (const auto& a : cloud) {
    for (const auto& b : cloud) expected += (a - b).norm() < 0.3 ? 1 : 0;
  }
  expected -= 1500;
  EXPECT_NEAR(static_cast<double>(voting::count_pair_votes(cloud, 0.3, 1)), static_cast<double>(expected), 1)
      << "a pair at the very rim may fall either way";
  EXPECT_EQ(voting::count_pair_votes(cloud, 0.3, 2), voting::count_pair_votes(cloud, 0.3, 1));
  EXPECT_EQ(voting::count_pair_votes({}, 0.3, 2), 0);
}

/// Multiplications and additions a second, each waiting for the one before.
double flops_per_s_of_one_chain() {
  constexpr int kRounds = 1'000'000;
  volatile float factor = 0.999F, term = 0.001F;
  const float a = factor, b = term;
  double best = 0;
  for (int stretch = 0; stretch < 10; ++stretch) {
    const auto begin = std::chrono::steady_clock::now();
    float x = a;
    for (int i = 0; i < kRounds; ++i) x = x * a + b;
    volatile float sink = x;
    (void)sink;
    best =
        std::max(best, 2 * kRounds / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

/// A chain waits about eight cycles for two operations. Whatever the machine, the peak has its vectors' lanes on top of
/// that, times as many operations as fit into the wait: 8 to 16 of them.
TEST(FmaPeakOfThisMachine, IsThatOfItsVectorsWithNothingToWaitFor) {
  const voting::FmaPeak peak = voting::measure_fma_peak(1, 0.05);
  const double lanes = peak.isa == "avx512" ? 16 : peak.isa == "avx2" ? 8 : 4;
  const double gain = peak.flops_per_s / flops_per_s_of_one_chain() / lanes;
  EXPECT_GT(gain, 2) << peak.isa << " " << peak.flops_per_s;
  EXPECT_LT(gain, 32) << peak.isa << " " << peak.flops_per_s;
}

TEST(FmaPeakOfThisMachine, CanBeThatOfANamedInstructionSet) {
#ifdef __x86_64__
  EXPECT_EQ(voting::measure_fma_peak(1, 0.02, "baseline").isa, "baseline");
#else
  EXPECT_GT(voting::measure_fma_peak(1, 0.02, "baseline").flops_per_s, 0);
#endif
}

TEST(MeasureBatch, TakesTheKernelThatIsNamed) {
  voting::BatchRow row{.points = 500, .threads = 1};
  voting::measure_batch(row, false, "baseline", {.rounds = 1, .min_time = 1e-6});
  EXPECT_GT(row.ours.wall_ms, 0);
  EXPECT_THROW(voting::measure_batch(row, false, "abacus", {.rounds = 1, .min_time = 1e-6}), std::invalid_argument);
}

TEST(PclNormals, GivesANormalToEveryPointWithNeighbours) {
  EXPECT_EQ(voting::PclNormals(voting::inputs::street_cloud(2000, 5), 0.9, 1).run(), 2000U);
}

TEST(TimeInTurn, EachHasItsTurnInEveryRoundUnlessItIsSlow) {
  std::string order;
  const std::vector<timing::Contender> contenders = {{"a", [&] { order += 'a'; }}, {"b", [&] { order += 'b'; }}};
  const auto times = timing::time_in_turn(contenders, {.rounds = 2, .min_time = 1e-9});
  ASSERT_EQ(times.size(), 2U);
  EXPECT_GT(times[0].wall_ms, 0);
  EXPECT_THAT(order, HasSubstr("ba")) << "a comes back after b";
  order.clear();
  (void)timing::time_in_turn(contenders, {.rounds = 5, .min_time = 1e-9, .slow = 0});
  EXPECT_EQ(order.find("ba"), std::string::npos) << "everything is slower than nothing";
}

class BenchVoting : public ::testing::Test {
 protected:
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "voting");
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int status =
        command::run_subcommand("bench voting", voting::run_bench_voting, static_cast<int>(argv.size()), argv.data());
    table_ = ::testing::internal::GetCapturedStdout();
    error_ = ::testing::internal::GetCapturedStderr();
    return status;
  }
  nlohmann::json json() const { return nlohmann::json::parse(std::ifstream(file_)); }

  test::TemporaryFolder folder_;
  fs::path file_ = folder_ / "figures.json";
  std::string table_;
  std::string error_;
};

TEST_F(BenchVoting, PrintsATableAndWritesTheSameFiguresForPrograms) {
  ASSERT_EQ(run({"--points", "2000,3000", "--sigma", "0.3", "--repetitions", "1", "--min-time", "0.001", "--seconds",
                 "6", "--pcl-max-points", "2000", "--json", file_.string()}),
            0)
      << error_;
  const auto json = this->json();
  ASSERT_EQ(json["batch"].size(), 2U);
  for (const auto& row : json["batch"]) {
    for (const char* key :
         {"points", "sigma", "radius", "threads", "ours_ms", "pair_votes_per_s", "fma_peak_share", "ours_cpu_ms"}) {
      EXPECT_GT(row.at(key).get<double>(), 0) << key;
    }
    EXPECT_LT(row["fma_peak_share"].get<double>(), 1);
    EXPECT_EQ(row["radius"], 0.9);
  }
  EXPECT_NEAR(json["batch"][0]["ratio"].get<double>(),
              json["batch"][0]["pcl_ms"].get<double>() / json["batch"][0]["ours_ms"].get<double>(), 1e-9);
  EXPECT_TRUE(json["batch"][1]["pcl_ms"].is_null()) << "too large for PCL, by option";
  EXPECT_NEAR(json["stick_sum"].get<double>(), 22779.8, 0.04 * 22779.8) << "as independent codes have it";

  const auto& incremental = json["incremental"];
  EXPECT_GT(incremental.at("mean_ms").get<double>(), 0);
  EXPECT_GE(incremental.at("p99_ms").get<double>(), incremental["mean_ms"].get<double>());
  EXPECT_LT(incremental.at("max_relative_difference").get<double>(), 1e-4);
  EXPECT_GT(incremental["revolutions"], 20);
  EXPECT_TRUE(json.contains("cuda"));
  EXPECT_THAT(table_, HasSubstr("FMA peak"));
  EXPECT_THAT(table_, HasSubstr("a worker, all of it"));
}

TEST_F(BenchVoting, SaysWhatIsWrongWithItsOptionsAndFiles) {
  EXPECT_EQ(run({"--sigma", "0"}), 2);
  EXPECT_EQ(run({"--threads", "0"}), 2);
  EXPECT_EQ(run({"--points", "many"}), 2);
  const std::vector<std::string> quick = {"--points", "100",        "--sigma", "0.3",        "--repetitions",
                                          "1",        "--min-time", "0.001",   "--no-growth"};
  auto bad_log = quick;
  bad_log.insert(bad_log.end(), {"--log", "/nowhere/drive.lcmlog"});
  EXPECT_EQ(run(bad_log), 1);
  EXPECT_THAT(error_, HasSubstr("/nowhere/drive.lcmlog"));
  auto bad_json = quick;
  bad_json.insert(bad_json.end(), {"--no-drive", "--json", "/nowhere/out.json"});
  EXPECT_EQ(run(bad_json), 1);
  EXPECT_THAT(error_, HasSubstr("/nowhere/out.json"));
}

}  // namespace
}  // namespace curbstone::bench
