#include "services/mapper/tracking/turn_check.hpp"

#include <gtest/gtest.h>

#include "services/mapper/scan/deskew.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::tracking {
namespace {

/// A vehicle at 3 m/s in a bend, scanned twenty times a second.
class TurnCheckTest : public ::testing::Test {
 protected:
  /// `otherwise`: rad/s that the scans show more than odometry.
  void drive(double seconds, double otherwise = 0) {
    for (double end = t_ + seconds - 0.01; t_ < end;) {
      step(otherwise);
      turns_.add(utime(), T_map_base_, T_odom_base_);
    }
  }
  bool next_contradicts(double otherwise) {
    step(otherwise);
    return turns_.contradicts(utime(), T_map_base_, T_odom_base_);
  }
  void step(double otherwise) {
    t_ += 0.05;
    T_odom_base_ = T_odom_base_ * scan::move({{3, 0, 0}, {0, 0, 0.3}}, 0.05);
    T_map_base_ = T_map_base_ * scan::move({{3, 0, 0}, {0, 0, 0.3 + otherwise}}, 0.05);
  }
  [[nodiscard]] std::int64_t utime() const { return 1'700'000'000'000'000 + std::llround(t_ * 1e6); }

  TurnCheck turns_;
  Pose T_map_base_ = test::pose(5, 3, 0, 0, 0, 1), T_odom_base_ = Pose::Identity();
  double t_ = 0;
};

TEST_F(TurnCheckTest, BeforeAnythingWasBelievedNothingIsContradicted) {
  EXPECT_FALSE(next_contradicts(3));
}

TEST_F(TurnCheckTest, DriftIsNoContradiction) {
  drive(20, 0.012);
  EXPECT_FALSE(next_contradicts(0.012));
}

TEST_F(TurnCheckTest, ABiasThatGrowsIsNoContradiction) {
  for (double bias = 0; bias < 0.05; bias += 0.001) {  // 2.9 deg/s in 50 s
    ASSERT_FALSE(next_contradicts(bias)) << bias;
    turns_.add(utime(), T_map_base_, T_odom_base_);
    drive(0.95, bias);
  }
}

TEST_F(TurnCheckTest, AScanThatStaysBehindIsOneAlsoWhereOdometryDrifts) {
  drive(12, 0.012);
  drive(0.05, -0.2);
  drive(0.05, -0.2);
  EXPECT_TRUE(next_contradicts(-0.2));
}

TEST_F(TurnCheckTest, AScanThatStaysBehindInTheBendIsOne) {
  drive(12);
  drive(0.05, -0.15);
  drive(0.05, -0.15);
  EXPECT_TRUE(next_contradicts(-0.15));
}

TEST_F(TurnCheckTest, OdometryLeadsFromBeforeItBegan) {
  drive(5);
  const Pose T_map_odom = T_map_base_ * T_odom_base_.inverse();
  drive(0.1, -0.15);
  step(-0.15);
  EXPECT_TRUE(turns_.by_odometry(T_odom_base_).isApprox(T_map_odom * T_odom_base_, 1e-9));
}

TEST_F(TurnCheckTest, OdometryThatHasAlwaysTurnedOtherwiseContradictsNothing) {
  drive(20, 0.02);
  EXPECT_FALSE(next_contradicts(0.02));
  EXPECT_FALSE(next_contradicts(-0.5));
}

TEST_F(TurnCheckTest, OdometryIsOnProbationAfterItTurnedOtherwise) {
  drive(12);
  drive(2, 0.02);  // it was not confirmed: the scans were believed
  drive(9);
  EXPECT_FALSE(next_contradicts(-0.4));
}

TEST_F(TurnCheckTest, OdometryIsBelievedAgainAfterIt) {
  drive(12);
  drive(2, 0.02);
  drive(12);
  EXPECT_TRUE(next_contradicts(-0.4));
}

TEST_F(TurnCheckTest, AfterTenSecondsTheScansAreBelievedAgain) {
  drive(12);
  T_map_base_ = T_map_base_ * test::pose(0, 0, 0, 0, 0, 0.1);
  for (int i = 0; i < 199; ++i) ASSERT_TRUE(next_contradicts(0)) << i;
  for (int i = 0; i < 3; ++i) step(0);
  EXPECT_FALSE(next_contradicts(0));
}

TEST_F(TurnCheckTest, AClockThatWasSetBackBeginsAnew) {
  drive(12);
  t_ -= 3;
  T_map_base_ = T_map_base_ * test::pose(0, 0, 0, 0, 0, 0.1);
  EXPECT_FALSE(next_contradicts(0));
  turns_.add(utime(), T_map_base_, T_odom_base_);
  EXPECT_FALSE(next_contradicts(0));
}

}  // namespace
}  // namespace curbstone::mapper::tracking
