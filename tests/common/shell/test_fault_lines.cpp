#include "common/shell/fault_lines.hpp"

#include <gmock/gmock.h>

#include "tests/stamps.hpp"

namespace curbstone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kSecond;

class FaultLinesTest : public ::testing::Test {
 protected:
  /// A report a second, as the shell makes them. Returns what was written.
  std::vector<std::string> report(const std::vector<std::string>& faults, int seconds) {
    std::vector<std::string> written;
    for (int i = 0; i < seconds; ++i) {
      for (std::string& line : lines_.update(faults, now_)) written.push_back(std::move(line));
      now_ += kSecond;
    }
    return written;
  }
  FaultLines lines_;
  std::int64_t now_ = 5 * kSecond;
};

TEST_F(FaultLinesTest, AFaultThatStaysIsWrittenOnceAndItsEndOnce) {
  EXPECT_THAT(report({"no IMU"}, 3600), ElementsAre("no IMU"));
  EXPECT_THAT(report({}, 10), ElementsAre("over: no IMU"));
}

TEST_F(FaultLinesTest, WhatAStartPassesThroughIsNotWritten) {
  EXPECT_THAT(report({"no IMU"}, 2), IsEmpty());
  EXPECT_THAT(report({}, 10), IsEmpty());
}

TEST_F(FaultLinesTest, NumbersMakeNoOtherFault) {
  EXPECT_THAT(report({"no sample for 1 s"}, 1), IsEmpty());
  EXPECT_THAT(report({"no sample for 9 s"}, 1), IsEmpty());
  EXPECT_THAT(report({"no sample for 10.5 s"}, 1), ElementsAre("no sample for 10.5 s"));
  EXPECT_THAT(report({"no sample for 2000 s"}, 1), IsEmpty());
}

TEST_F(FaultLinesTest, TwoFaultsAreTwoLines) {
  EXPECT_THAT(report({"no IMU", "no wheels"}, 5), ElementsAre("no IMU", "no wheels"));
  EXPECT_THAT(report({"no wheels"}, 5), ElementsAre("over: no IMU"));
}

TEST_F(FaultLinesTest, AFaultThatComesAndGoesIsWrittenLessAndLessOften) {
  std::vector<int> written;  // in each half hour
  for (int half_hour = 0; half_hour < 4; ++half_hour) {
    written.push_back(0);
    for (int i = 0; i < 180; ++i) {
      written.back() += static_cast<int>(report({"no IMU"}, 5).size());
      report({}, 5);
    }
  }
  EXPECT_LE(written[0], 9);
  EXPECT_LE(written[3], 3);
  EXPECT_GE(written[3], 1) << "not for ever";
}

TEST_F(FaultLinesTest, AFaultThatWasAwayForLongIsANewOne) {
  for (int i = 0; i < 30; ++i) {
    report({"no IMU"}, 5);
    report({}, 5);
  }
  report({}, 700);
  EXPECT_THAT(report({"no IMU"}, 5), ElementsAre("no IMU"));
}

TEST_F(FaultLinesTest, SoManyFaultsThatNobodyReadsThemTakeNoMoreMemory) {
  std::size_t written = 0;
  std::string name;
  for (int i = 0; i < 1000; ++i) written += report({name += 'x'}, 4).size();
  EXPECT_LE(written, 2 * FaultLines::kMaxFaults * (4000 / 600 + 1));
}

}  // namespace
}  // namespace curbstone
