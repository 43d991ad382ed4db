#include "services/mapper/lidar_at_start.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace curbstone::mapper {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The yaw is tried in MapperNode's drives: test_mapper_new_drive.cpp.
class LidarAtStartTest : public ::testing::Test {
 protected:
  [[nodiscard]] LidarAtStart::Look upside_down(double driven) {
    utime_ += 50'000;
    LidarAtStart::Look look{utime_, &points_, Pose::Identity(), std::nullopt, true};
    look.T_map_base.translation().x() = driven;
    return look;
  }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    lidar_.add_faults(faults);
    return faults;
  }

  VehicleConfig vehicle_;
  LidarAtStart lidar_{vehicle_};
  std::vector<scan::LidarPoint> points_;
  std::int64_t utime_ = 0;
};

TEST_F(LidarAtStartTest, OneThatHangsUpsideDownIsTurnedOverOnce) {
  lidar_.begin();
  EXPECT_TRUE(lidar_.add(upside_down(0)));
  EXPECT_DOUBLE_EQ(lidar_.lidar()[3], vehicle_.lidar[3] + std::numbers::pi);
  EXPECT_FALSE(lidar_.add(upside_down(0.1))) << "what was said before it was turned over counts once";
  EXPECT_EQ(lidar_.counters()["lidar_turned_over"], 1);
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("upside down")));
}

TEST_F(LidarAtStartTest, BeyondTheStartOfTheDriveNothingIsCorrectedAnyMore) {
  lidar_.begin();
  EXPECT_FALSE(lidar_.add(upside_down(LidarAtStart::kStartOfDrive + 1)));
  EXPECT_FALSE(lidar_.add(upside_down(0))) << "driven back to where it began";
  EXPECT_EQ(lidar_.lidar(), vehicle_.lidar);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(LidarAtStartTest, OnAMapThatWasThereBeforeNothingIsCorrected) {
  EXPECT_FALSE(lidar_.add(upside_down(0)));
  EXPECT_EQ(lidar_.lidar(), vehicle_.lidar);
}

}  // namespace
}  // namespace curbstone::mapper
