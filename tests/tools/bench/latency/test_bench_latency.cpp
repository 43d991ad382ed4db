#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/stamps.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/bench/latency/latency_bench.hpp"
#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone::bench::latency {
namespace {

/// The town's first seconds: it stands, then sets off.
class LatencyBench : public ::testing::Test {
 protected:
  [[nodiscard]] nlohmann::json measure(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "latency");
    arguments.insert(arguments.end(), {log(), "--json", folder_ / "figures.json"});
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(run_bench_latency(static_cast<int>(words.size()), words.data()), 0);
    printed_ = ::testing::internal::GetCapturedStdout();
    std::ifstream in(folder_ / "figures.json");
    return nlohmann::json::parse(in);
  }
  [[nodiscard]] std::string log() const {
    const std::string path = folder_ / "town.lcmlog";
    if (!std::ifstream(path)) {
      const simulate::TownSetup setup(1, 8.0, test::kStart);
      (void)simulate::record_drive(setup.drive(), path);
    }
    return path;
  }

  test::TemporaryFolder folder_;
  mutable std::string printed_;
};

TEST_F(LatencyBench, SaysHowOldAMeasurementIsOnTheBus) {
  const auto json = measure({});
  EXPECT_NEAR(json.at("seconds").get<double>(), 8.0, 0.2);
  for (const char* channel : {"MAP_POSE", "MAP_POINTS", "VOTED_POINTS", "SEMANTIC_TILE"}) {
    EXPECT_GT(json.at("ms").at(channel).at("p50").get<double>(), 0) << channel;
    EXPECT_LT(json.at("ms").at(channel).at("p50").get<double>(), 1000) << channel;
  }
  const auto median = [&](const char* of) { return json.at("ms").at(of).at("p50").get<double>(); };
  EXPECT_GT(json.at("ms").at("all points, to CURBS").at("count").get<int>(), 1000);
  EXPECT_GT(median("all points, to CURBS"), median("all points, to its curbs"));
  EXPECT_LT(median("all points, to CURBS"), median("all points, to its curbs") + 200) << "lines wait no longer";
}

TEST_F(LatencyBench, CutsALongDriveIntoParts) {
  const auto parts = measure({"--every", "3"}).at("parts");
  ASSERT_EQ(parts.size(), 2U) << "what is left over is no part";
  EXPECT_NEAR(parts[0].at("s").get<double>(), 3, 0.1);
  EXPECT_NEAR(parts[1].at("s").get<double>(), 6, 0.1);
  EXPECT_LT(parts[0].at("m").get<double>(), parts[1].at("m").get<double>());
  EXPECT_LE(parts[1].at("m").get<double>(), 6 * 3.2);
  EXPECT_GT(parts[1].at("tiles").get<int>(), 50);
  for (const auto& part : parts) {
    EXPECT_GT(part.at("memory_mb").get<double>(), 1);
    EXPECT_GE(part.at("other_cores").get<double>(), 0);
    for (const char* process : {"ekf", "mapper", "tensor_voting", "semantic_map"}) {
      const double cores = part.at("cores").at(process).get<double>();
      const double longest = part.at("longest_ms").at(process).get<double>();
      EXPECT_GT(cores, 0) << process;
      EXPECT_GT(longest, 0) << process;
      EXPECT_LE(longest, 1e3 * cores * 3.01) << process << ": a piece is no longer than the whole";
    }
  }
  EXPECT_NE(printed_.find("points to tile"), std::string::npos);
}

}  // namespace
}  // namespace curbstone::bench::latency
