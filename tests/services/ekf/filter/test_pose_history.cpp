#include "services/ekf/filter/pose_history.hpp"

#include <gtest/gtest.h>

namespace curbstone::ekf::filter {
namespace {

constexpr std::size_t kCapacity = 10;

/// A pose `metres` ahead, turned by a tenth of that.
Pose ahead(double metres) {
  Pose T = Pose::Identity();
  T.translation().x() = metres;
  T.linear() = rotation_from_rpy(0, 0, 0.1 * metres);
  return T;
}

class PoseHistoryTest : public ::testing::Test {
 protected:
  PoseHistoryTest() {
    for (int i = 0; i < 2 * static_cast<int>(kCapacity); ++i) history_.add(1000 * i, ahead(i));
  }
  PoseHistory history_{kCapacity};
};

TEST_F(PoseHistoryTest, GivesItsEntriesBitForBit) {
  EXPECT_EQ(history_.at(15'000)->matrix(), ahead(15).matrix());
  EXPECT_EQ(history_.at(10'000)->matrix(), ahead(10).matrix()) << "the oldest";
}

TEST_F(PoseHistoryTest, InterpolatesPlaceAndTurnBetweenThem) {
  const auto between = history_.at(15'250);
  ASSERT_TRUE(between);
  EXPECT_LT((between->translation() - Eigen::Vector3d(15.25, 0, 0)).norm(), 1e-9);
  EXPECT_NEAR(roll_pitch_yaw(between->linear()).z(), 1.525, 1e-9);
}

TEST_F(PoseHistoryTest, KnowsNothingBeforeItsOldestAndAfterItsNewestEntry) {
  EXPECT_FALSE(history_.at(9'999)) << "it was dropped: the capacity is ten";
  EXPECT_FALSE(history_.at(19'001));
}

TEST_F(PoseHistoryTest, IgnoresAnEntryThatIsNotNewer) {
  history_.add(19'000, ahead(0));
  history_.add(5'000, ahead(0));
  EXPECT_EQ(history_.at(19'000)->matrix(), ahead(19).matrix());
}

}  // namespace
}  // namespace curbstone::ekf::filter
