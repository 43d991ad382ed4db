#include "services/mapper/tracking/tracking_state.hpp"

#include <gtest/gtest.h>

namespace curbstone::mapper::tracking {
namespace {

/// A vehicle at 20 m/s, scanned twenty times a second.
class TrustOfADrive : public ::testing::Test {
 protected:
  /// Scans in a row, and whether the map for registration begins anew with the last of them.
  bool drive(int scans, bool fits, bool with_odometry = true, bool sparse = false) {
    bool map_restarted = false;
    for (int i = 0; i < scans && !map_restarted; ++i) {
      utime_ += 50'000;
      const TrackingState::ScanResult scan{utime_, 0.05, 1.0, with_odometry, fits, registration::Matrix6::Identity(),
                                           sparse};
      map_restarted = tracking_state_.judge(scan, counters_);
    }
    return map_restarted;
  }

  TrackingState tracking_state_;
  Counters counters_;
  std::int64_t utime_ = 0;
};

TEST_F(TrustOfADrive, IsKeptThroughASecondWithoutAFitAndThenLost) {
  drive(10, true);
  drive(20, false);
  EXPECT_EQ(tracking_state_.fix(), Fix::kTracking);
  EXPECT_DOUBLE_EQ(tracking_state_.uncertainty(), 20 * 0.05);  // a twentieth of the way
  EXPECT_DOUBLE_EQ(tracking_state_.drift()(0, 0), 20);
  const TrackingState::ScanResult next{utime_ + 50'000, 0.05, 1.0, true, false, registration::Matrix6::Identity()};
  EXPECT_DOUBLE_EQ(tracking_state_.covariance_without(next)(0, 0), 21 + 1.05 * 1.05);
  EXPECT_DOUBLE_EQ(tracking_state_.covariance_without(next)(5, 5), 21);
  drive(1, false);
  EXPECT_EQ(tracking_state_.fix(), Fix::kLost);
  EXPECT_FALSE(tracking_state_.unbounded()) << "odometry tells how far";
  EXPECT_EQ(counters_["lost.refused"], 1);
}

TEST_F(TrustOfADrive, IsKeptWhileOdometryIsGoodToHalfAMetreWhereNothingIsSeen) {
  drive(10, true);
  drive(9, false, true, true);
  EXPECT_EQ(tracking_state_.fix(), Fix::kTracking);
  EXPECT_EQ(tracking_state_.refused_in_a_row(), 0) << "nothing was tried";
  EXPECT_DOUBLE_EQ(tracking_state_.uncertainty(), 9 * 0.05);
  drive(20, false, true, true);
  EXPECT_EQ(tracking_state_.fix(), Fix::kLost) << "and longer than a second";
}

TEST_F(TrustOfADrive, DoesNotBeginAnewWithAScanThatShowsNothing) {
  drive(10, true);
  EXPECT_FALSE(drive(300, false, true, true));
  EXPECT_TRUE(drive(1, false));
}

TEST_F(TrustOfADrive, ComesBackWhenTenScansInARowFit) {
  drive(30, false);
  drive(9, true);
  EXPECT_EQ(tracking_state_.fix(), Fix::kTentative);
  EXPECT_GT(tracking_state_.uncertainty(), 0);
  drive(1, true);
  EXPECT_EQ(tracking_state_.fix(), Fix::kTracking);
  EXPECT_EQ(tracking_state_.uncertainty(), 0);
  EXPECT_EQ(counters_["found"], 1);
}

TEST_F(TrustOfADrive, IsGoneAtTheFirstMisfitWhileTentative) {
  drive(30, false);
  drive(9, true);
  drive(1, false);
  EXPECT_EQ(tracking_state_.fix(), Fix::kLost);
}

TEST_F(TrustOfADrive, BeginsAnewOnNewGroundIfOdometryLedThere) {
  drive(10, true);
  EXPECT_TRUE(drive(200, false));
  EXPECT_EQ(utime_, 10 * 50'000 + 6'050'000) << "once it has been sought everywhere";
  EXPECT_EQ(tracking_state_.fix(), Fix::kTracking);
  EXPECT_EQ(counters_["began_anew"], 1);
}

TEST_F(TrustOfADrive, NeverBeginsAnewWhenNothingMeasuredTheMotion) {
  drive(10, true);
  tracking_state_.go_blind(counters_);
  EXPECT_TRUE(tracking_state_.unbounded());
  EXPECT_FALSE(drive(400, false));
  EXPECT_EQ(counters_["lost.blind"], 1);

  tracking_state_.relocate();
  EXPECT_EQ(tracking_state_.fix(), Fix::kTentative);
  EXPECT_FALSE(tracking_state_.unbounded());
}

TEST_F(TrustOfADrive, NorWhereItWasFoundInVainAfterThat) {
  drive(10, true);
  tracking_state_.go_blind(counters_);
  drive(200, false);
  tracking_state_.relocate();
  drive(5, true);
  EXPECT_FALSE(tracking_state_.was_unobserved());
  EXPECT_FALSE(drive(400, false)) << "odometry did not lead from the map to there";
  EXPECT_TRUE(tracking_state_.was_unobserved());
  tracking_state_.relocate();
  drive(10, true);
  EXPECT_TRUE(drive(200, false)) << "from where it was found for sure it did";
}

TEST_F(TrustOfADrive, IsAdriftOnlyWhereSomethingOfTheWayIsUnknown) {
  drive(10, true);
  drive(30, false);
  EXPECT_EQ(tracking_state_.fix(), Fix::kLost);
  EXPECT_FALSE(tracking_state_.was_unobserved());
  tracking_state_.go_blind(counters_);
  EXPECT_TRUE(tracking_state_.was_unobserved());
}

}  // namespace
}  // namespace curbstone::mapper::tracking
