#include "tools/bench/faults/faults_bench.hpp"

#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "tests/temporary_folder.hpp"
#include "tools/bench/faults/fault_limits.hpp"
#include "tools/bench/faults/fault_report.hpp"
#include "tools/bench/faults/fault_rows.hpp"
#include "tools/bench/faults/small_disk.hpp"

namespace curbstone::bench::faults {
namespace {

using ::testing::HasSubstr;

TEST(FaultRows, HaveNamesOfTheirOwnAndBeginWithNoFault) {
  std::set<std::string> names;
  for (const Fault& fault : all_faults()) EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
  EXPECT_EQ(all_faults().front().name, "none");
}

TEST(FaultReport, SaysWhatWasNotBackBeforeTheEnd) {
  const test::TemporaryFolder folder;
  FaultReport report;
  report.undisturbed = {{.seconds = 18, .cells = 1000, .poses = 360}};
  report.rows = {{"none", 12, 0, 0.0, {}, true, "ok", 0.01},
                 {"kill -9 mapper", 500, 3, std::nullopt, {"ekf: lost", "mapper: lost"}, false, "ok", 0.02}};
  const auto lines = table_lines(report);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_THAT(lines[1], HasSubstr("0.0  ok   yes"));
  EXPECT_THAT(lines[2], HasSubstr("not  ok   NO"));
  EXPECT_THAT(lines[2], HasSubstr("ekf: lost; mapper: lost"));

  write_report(report, folder / "figures.json");
  const auto json = nlohmann::json::parse(std::ifstream(folder / "figures.json"));
  EXPECT_EQ(json["rows"][0]["back_s"], 0.0);
  EXPECT_TRUE(json["rows"][1]["back_s"].is_null());
  EXPECT_EQ(json["rows"][1]["said"], "ekf: lost; mapper: lost");
  EXPECT_EQ(json["undisturbed"][0]["poses"], 360);
  EXPECT_THROW(write_report(report, "/nowhere/figures.json"), std::runtime_error);
}

TEST(FaultLimits, AreTwiceTheSpreadNoPoseAndASecond) {
  FaultReport report;
  report.undisturbed = {{.seconds = 18, .cells = 90'000, .poses = 361, .live_cells_differ = 200},
                        {.seconds = 60, .cells = 90'000, .poses = 361, .live_cells_differ = 0}};
  const FaultRow good{.fault = "good",
                      .cells_differ = 400,
                      .poses_missing = 0,
                      .back_s = 1.0,
                      .ended_cleanly = true,
                      .map = "ok",
                      .seconds = 18};
  report.rows = {good};
  EXPECT_THAT(broken_limits(report), ::testing::IsEmpty());
  const auto broken_by = [&](const std::function<void(FaultRow&)>& change) {
    report.rows = {good};
    change(report.rows[0]);
    return broken_limits(report);
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(broken_by([](FaultRow& row) { row.cells_differ = 401; }),
              ElementsAre("good: 401 cells differ, more than 400"));
  EXPECT_THAT(broken_by([](FaultRow& row) { row.cells_differ = 1333, row.seconds = 60; }), ::testing::IsEmpty())
      << "the spread grows with the ground that is driven over";
  EXPECT_EQ(broken_by([](FaultRow& row) { row.cells_differ = 1334, row.seconds = 60; }).size(), 1U);
  EXPECT_THAT(broken_by([](FaultRow& row) { row.poses_missing = 1; }), ElementsAre("good: 1 poses are missing"));
  EXPECT_THAT(broken_by([](FaultRow& row) { row.back_s = 1.2; }), ElementsAre(HasSubstr("back after 1.2 s")));
  EXPECT_THAT(broken_by([](FaultRow& row) { row.back_s.reset(); }), ElementsAre("good: not back before the end"));
  EXPECT_THAT(broken_by([](FaultRow& row) { row.ended_cleanly = false; }), ElementsAre(HasSubstr("ended")));
  EXPECT_THAT(broken_by([](FaultRow& row) { row.map = "malformed"; }), ElementsAre(HasSubstr("malformed")));
  const auto much = [](FaultRow& row) { row.cells_differ = 9000, row.poses_missing = 40, row.back_s = 5.0; };
  EXPECT_EQ(broken_by(much).size(), 3U);
  EXPECT_EQ(broken_by([&](FaultRow& row) { much(row), row.excuse = {Excuse::Covers::kTime, "slow"}; }).size(), 2U);
  EXPECT_EQ(broken_by([&](FaultRow& row) { much(row), row.excuse = {Excuse::Covers::kAll, "gone"}; }).size(), 0U);
  EXPECT_THAT(broken_by([&](FaultRow& row) { much(row), row.emulator_late_s = 1; }), ::testing::IsEmpty());
  EXPECT_THAT(unjudged(report), ElementsAre("good"));
}

TEST(FaultReport, ComparesNothingWithADriveThatTheMachineSpoiled) {
  Undisturbed drive{.seconds = 18, .cells = 1000, .poses = 360, .emulator_late_s = 0.02, .said = {"ekf: late"}};
  EXPECT_FALSE(drive.is_spoiled());
  EXPECT_THAT(to_line(drive), HasSubstr("0.02 s late, 0 revolutions lost"));
  EXPECT_THAT(to_line(drive), HasSubstr("said: ekf: late"));
  EXPECT_THAT(to_line(drive), ::testing::Not(HasSubstr("SPOILED")));
  drive.emulator_late_s = 0.11;
  EXPECT_TRUE(drive.is_spoiled());
  EXPECT_THAT(to_line(drive), HasSubstr("SPOILED"));
  drive.emulator_late_s = 0;
  drive.revolutions_lost = 1;
  EXPECT_TRUE(drive.is_spoiled());

  const test::TemporaryFolder folder;
  FaultReport report{.undisturbed = {drive}, .rows = {{.fault = "kill -9 mapper", .map = "ok"}}};
  EXPECT_THAT(table_lines(report)[1], HasSubstr("spoiled"));
  write_report(report, folder / "figures.json");
  const auto json = nlohmann::json::parse(std::ifstream(folder / "figures.json"));
  EXPECT_TRUE(json["undisturbed"][0]["spoiled"]);
  EXPECT_EQ(json["undisturbed"][0]["revolutions_lost"], 1);
  EXPECT_TRUE(json["rows"][0]["cells_differ"].is_null());
}

TEST(FaultReport, SaysWhichRowsTheMachineSpoiled) {
  const test::TemporaryFolder folder;
  const FaultRow row{.fault = "kill -9 ekf", .ended_cleanly = true, .map = "ok", .emulator_late_s = 0.4, .drives = 2};
  FaultReport report;
  report.rows = {row};
  EXPECT_THAT(table_lines(report)[1], HasSubstr("spoiled        spoiled  spoiled  ok   yes"));
  write_report(report, folder / "figures.json");
  const auto json = nlohmann::json::parse(std::ifstream(folder / "figures.json"));
  EXPECT_TRUE(json["rows"][0]["spoiled"]);
  EXPECT_EQ(json["rows"][0]["drives"], 2);
  EXPECT_TRUE(json["rows"][0]["back_s"].is_null());
}

TEST(SmallDisk, IsFullAndFreeAgainAndNobodyElsesBusiness) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "file";
  const auto can_write = [&] {
    std::ofstream stream(file, std::ios::app);
    stream << std::string(100'000, 'x') << std::flush;
    return stream.good();
  };
  std::optional<SmallDisk> disk;
  try {
    disk.emplace(folder.path().string(), 4);
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_TRUE(can_write());
  disk->fill();
  EXPECT_FALSE(can_write());
  disk->free();
  EXPECT_TRUE(can_write());
  disk.reset();
  EXPECT_FALSE(std::filesystem::exists(file)) << "what was on it is gone";
}

}  // namespace
}  // namespace curbstone::bench::faults
