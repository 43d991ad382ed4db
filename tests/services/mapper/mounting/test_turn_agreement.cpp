#include "services/mapper/mounting/turn_agreement.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::mounting {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// 20 revolutions a second of a vehicle that drives a bend.
class TurnAgreementTest : public ::testing::Test {
 protected:
  /// `map_turn`, `map_pitch`: rad/s that the LiDAR shows more than odometry.
  void drive(double seconds, double map_turn = 0, double map_pitch = 0) {
    for (double end = t_ + seconds; t_ < end; t_ += 0.05) {
      T_odom_base_ = T_odom_base_ * scan::move({{3, 0, 0}, {0, 0, 0.5}}, 0.05);
      T_map_base_ = T_map_base_ * scan::move({{3, 0, 0}, {0, map_pitch, 0.5 + map_turn}}, 0.05);
      turns_.add(test::utime(t_), T_map_base_, T_odom_base_);
    }
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    turns_.add_faults(faults);
    return faults;
  }
  Pose T_map_base_ = test::pose(5, 3, 0, 0, 0, 1), T_odom_base_ = Pose::Identity();
  double t_ = 0;
  TurnAgreement turns_;
};

TEST_F(TurnAgreementTest, DriftIsNoFault) {
  drive(20, 0.012, 0.01);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(TurnAgreementTest, ALidarThatFollowsSomethingElseIsReportedForAMinute) {
  drive(5);
  drive(3, -0.08);
  ASSERT_EQ(faults().size(), 1U);
  EXPECT_THAT(faults()[0], HasSubstr("differ by 4.6 deg in how it turned within a second, 0 s ago"));
  drive(58);
  EXPECT_EQ(faults().size(), 1U);
  drive(4);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_EQ(turns_.counters()["faults.apart.turn"], 1);
}

TEST_F(TurnAgreementTest, AMountThatSlipsIsReportedAtOnce) {
  drive(5);
  drive(0.05, 0, 1.2);  // 3.4 deg from one revolution to the next
  ASSERT_EQ(faults().size(), 1U);
  EXPECT_THAT(faults()[0], HasSubstr("it has tilted by 3.4 deg against odometry"));
}

TEST_F(TurnAgreementTest, WhatIsFoundElsewhereIsNoTurn) {
  drive(5);
  turns_.interrupt();
  T_map_base_ = T_map_base_ * test::pose(10, 0, 0, 0, 0.2, 1);
  drive(5);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(TurnAgreementTest, AClockThatLeapsIsNoTurn) {
  drive(5);
  for (const double leap : {3600.0, -7200.0}) {
    t_ += leap;
    T_map_base_ = T_map_base_ * test::pose(0, 0, 0, 0, 0, 0.5);
    drive(2);
  }
  EXPECT_THAT(faults(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::mounting
