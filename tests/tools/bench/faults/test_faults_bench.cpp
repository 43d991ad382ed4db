#include "tools/bench/faults/faults_bench.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/temporary_folder.hpp"
#include "tools/bench/faults/fault_report.hpp"
#include "tools/bench/faults/fault_rows.hpp"

namespace curbstone::bench::faults {
namespace {

using ::testing::HasSubstr;

TEST(FaultRows, HaveNamesOfTheirOwnAndBeginWithNoFault) {
  std::set<std::string> names;
  for (const Fault& fault : all_faults()) EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
  EXPECT_EQ(all_faults().front().name, "none");
}

TEST(FaultReport, SaysWhatWasNotBackBeforeTheEnd) {
  const testing::TemporaryFolder folder;
  FaultReport report;
  report.undisturbed = {{18, 1000, 360}};
  report.rows = {{"none", 12, 0, 0.0, {}, true, "ok", 0.01},
                 {"kill -9 mapper", 500, 3, std::nullopt, {"ekf: lost", "mapper: lost"}, false, "ok", 0.2}};
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

}  // namespace
}  // namespace curbstone::bench::faults
