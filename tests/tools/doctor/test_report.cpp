#include "tools/doctor/report.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace curbstone::doctor {
namespace {

using ::testing::ElementsAre;

const checks::Verdicts kVerdicts = {checks::good("route", "over lo"),
                                    checks::finding("folder", "/data is not there", "mkdir /data"),
                                    checks::unknown("lidar", "not looked at", "be root")};

TEST(DoctorReport, HasALineACheckWithItsFix) {
  EXPECT_THAT(report_lines(kVerdicts, {}), ElementsAre("    check   what",                                  //
                                                       "ok  route   over lo",                               //
                                                       "!!  folder  /data is not there; fix: mkdir /data",  //
                                                       "?   lidar   not looked at; fix: be root",           //
                                                       "1 of 3 checks found something"));
}

TEST(DoctorReport, JsonHasTheSame) {
  const auto json = nlohmann::json::parse(report_json(kVerdicts));
  EXPECT_EQ(json["findings"], 1);
  ASSERT_EQ(json["checks"].size(), 3U);
  EXPECT_EQ(json["checks"][1]["check"], "folder");
  EXPECT_EQ(json["checks"][1]["kind"], "finding");
  EXPECT_EQ(json["checks"][1]["fix"], "mkdir /data");
}

TEST(DoctorReport, OnlyFindingsAreAFailure) {
  EXPECT_EQ(exit_status(kVerdicts), 1);
  EXPECT_EQ(exit_status({kVerdicts[0], kVerdicts[2]}), 0);
}

}  // namespace
}  // namespace curbstone::doctor
