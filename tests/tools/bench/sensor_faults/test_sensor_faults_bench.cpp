#include "tools/bench/sensor_faults/sensor_faults_bench.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/temporary_folder.hpp"
#include "tools/bench/sensor_faults/report.hpp"
#include "tools/bench/sensor_faults/witness.hpp"

namespace curbstone::bench::sensor_faults {
namespace {

using ::testing::HasSubstr;

/// A node that reports what it is told to.
struct ToldNode : Node {
  void connect(Subscriber&) override {}
  [[nodiscard]] NodeReport report() const override { return told; }
  NodeReport told;
};

struct OneStage {
  OneStage() {
    auto node = std::make_unique<ToldNode>();
    told = &node->told;
    stages.push_back({"ekf", "", std::move(node)});
  }
  std::vector<replay::Stage> stages;
  NodeReport* told;
};

TEST(SensorFaultWitness, NamesWhatTheUndisturbedDriveDidNotSay) {
  OneStage vehicle;
  Witness undisturbed, disturbed;
  vehicle.told->faults = {"waiting for 1.0 s"};
  vehicle.told->counters.add("refused.time", 3);
  vehicle.told->counters.add("keyframes", 9);
  undisturbed.look(0.5, vehicle.stages);
  vehicle.told->faults.clear();
  undisturbed.look(1.0, vehicle.stages);
  EXPECT_EQ(undisturbed.new_faults(undisturbed, 0).size(), 0U);
  EXPECT_EQ(undisturbed.new_counters(undisturbed, 0).size(), 0U);

  for (double t = 0.5; t < 10; t += 0.5) {
    vehicle.told->faults = {"waiting for " + std::to_string(t) + " s"};
    if (t >= 4) vehicle.told->faults.emplace_back("IMU: silent for " + std::to_string(t) + " s");
    if (t == 6) vehicle.told->counters.add("refused.time");
    disturbed.look(t, vehicle.stages);
  }
  const auto faults = disturbed.new_faults(undisturbed, 0);
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].at, 2.5) << "2 s longer than usual";
  EXPECT_EQ(faults[1].at, 4.0);
  EXPECT_THAT(faults[1].words, HasSubstr("IMU: silent for 4"));
  EXPECT_EQ(disturbed.new_faults(undisturbed, 5)[0].at, 5.0) << "not before the fault";
  const auto counters = disturbed.new_counters(undisturbed, 0);
  ASSERT_EQ(counters.size(), 1U) << "keyframes are no loss";
  EXPECT_EQ(counters[0].words, "refused.time");
  EXPECT_EQ(counters[0].at, 6.0);
}

TEST(SensorFaultReport, ABadMapThatNobodyNamesIsToBeSeen) {
  Row row{.sensor = "IMU", .name = "gyro 0", .words = "all rates are 0", .from = 15};
  row.map = MapFigures{.precision = 1, .recall = 0.9, .f1 = 0.95, .class_accuracy = 0.98, .ate = 0.01};
  EXPECT_EQ(row.verdict(), "good");
  row.map->f1 = 0.5;
  EXPECT_EQ(row.verdict(), "BAD, UNNAMED");
  EXPECT_THAT(table_lines({row})[1], HasSubstr("BAD, UNNAMED"));
  row.counters = {{"ekf", "refused.time", 16, 16, 1}};
  EXPECT_EQ(row.verdict(), "BAD, counted");
  row.faults = {{"ekf", "IMU: stuck", 17.5, 30}, {"mapper", "lost", 20, 30}};
  EXPECT_EQ(row.verdict(), "bad, named");
  EXPECT_THAT(table_lines({row})[1], HasSubstr("2.5  ekf: IMU: stuck"));
  Row none = row;
  none.map.reset();
  none.faults.clear();
  none.failure = "no time in common";
  EXPECT_EQ(none.verdict(), "BAD, counted");

  const test::TemporaryFolder folder;
  const Row undisturbed{.sensor = "none", .name = "none", .words = "", .map = MapFigures{.f1 = 1}};
  write_report({undisturbed, row, none}, folder / "figures.json");
  const auto json = nlohmann::json::parse(std::ifstream(folder / "figures.json"));
  EXPECT_EQ(json["counts"]["faults"], 2);
  EXPECT_EQ(json["counts"]["bad_named"], 1);
  EXPECT_EQ(json["counts"]["bad_unnamed"], 1);
  EXPECT_EQ(json["rows"][0]["said_first"], "nothing");
  EXPECT_EQ(json["rows"][1]["said_first"], "2.5 s: ekf: IMU: stuck");
  EXPECT_EQ(json["rows"][1]["said_later"], "mapper: lost");
  EXPECT_EQ(json["rows"][1]["f1"], 0.5);
  EXPECT_FALSE(json["rows"][2].contains("f1"));
  EXPECT_EQ(json["rows"][2]["failure"], "no time in common");
}

int run(std::vector<std::string> words) {
  words.insert(words.begin(), "sensor-faults");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  return run_bench_sensor_faults(static_cast<int>(arguments.size()), arguments.data());
}

TEST(SensorFaultsBench, AShortDriveWithTwoFaults) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "figures.json";
  ASSERT_EQ(run({"--seed", "3", "--seconds", "20", "--jobs", "2", "--only", "^wheels: (wheels silent|left backwards)$",
                 "--json", file}),
            0);
  const auto json = nlohmann::json::parse(std::ifstream(file));
  ASSERT_EQ(json["rows"].size(), 3U);
  EXPECT_EQ(json["rows"][0]["fault"], "none");
  EXPECT_GT(json["rows"][0]["f1"], 0.5);
  EXPECT_EQ(json["rows"][1]["fault"], "left backwards");
  EXPECT_THAT(json["rows"][1]["said_first"], HasSubstr("left wheel"));
  EXPECT_EQ(json["rows"][2]["fault"], "wheels silent");
  EXPECT_THAT(json["rows"][2]["said_first"], HasSubstr("wheels"));
}

TEST(SensorFaultsBench, ADriveInWhichNothingIsWrong) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "figures.json";
  ASSERT_EQ(run({"--seed", "3", "--seconds", "20", "--faultless", "--only", "sets off at once", "--json", file}), 0);
  const auto json = nlohmann::json::parse(std::ifstream(file));
  ASSERT_EQ(json["rows"].size(), 2U);
  EXPECT_EQ(json["rows"][0]["said_first"], "nothing");
  EXPECT_GT(json["rows"][1]["f1"], 0.9);
  EXPECT_THAT(json["rows"][1]["said_first"], HasSubstr("not level yet"))
      << "all that is said, from the first second on";
}

TEST(SensorFaultsBench, RefusesWhatItCannotDo) {
  EXPECT_EQ(run({"--only", "no such fault"}), 1);
  EXPECT_EQ(run({"--log", "some.lcmlog"}), 2);
  EXPECT_EQ(run({"--list"}), 0);
  EXPECT_EQ(run({"--faultless", "--only", "wheels: wheels silent"}), 1);
}

}  // namespace
}  // namespace curbstone::bench::sensor_faults
