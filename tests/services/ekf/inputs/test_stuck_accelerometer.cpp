#include "services/ekf/inputs/stuck_accelerometer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace curbstone::ekf::inputs {
namespace {

constexpr double kTestWheelRadius = 0.2;  // m

class StuckAccelerometerTest : public ::testing::Test {
 protected:
  /// Drives on for a while at 100 samples a second; axes of `held` show what they showed last. True if any was called
  /// stuck meanwhile.
  bool drive(double seconds, double speed, const std::array<bool, 3>& held = {}, double step = 0.0) {
    bool stuck = false;
    for (int i = 0; i < std::lround(100 * seconds); ++i) {
      utime_ += 10'000;
      angle_ += 0.01 * speed / kTestWheelRadius;
      watch_.add(base::WheelSample{utime_, {angle_, angle_}});
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (held[axis]) continue;
        const double force = (axis == 2 ? 9.81 : 0.0) + 0.05 * normal_(engine_);
        shown_[static_cast<Eigen::Index>(axis)] = step > 0 ? step * std::round(force / step) : force;
      }
      base::ImuSample sample;
      sample.utime = utime_;
      sample.acceleration = shown_;
      stuck |= watch_.add(sample);
    }
    return stuck;
  }
  StuckAccelerometer watch_{kTestWheelRadius};

 private:
  std::int64_t utime_ = 1'000'000;
  double angle_ = 0.0;
  Eigen::Vector3d shown_ = Eigen::Vector3d::Zero();
  std::mt19937 engine_{3};
  std::normal_distribution<double> normal_;
};

TEST_F(StuckAccelerometerTest, OneThatLivesIsNot) {
  EXPECT_FALSE(drive(60, 3.0));
  EXPECT_FALSE(drive(60, 3.0, {}, 0.04));  // in steps of 4 mg
}

TEST_F(StuckAccelerometerTest, AnAxisThatRepeatsItselfOnTheWayIs) {
  drive(5, 3.0);
  EXPECT_TRUE(drive(1, 3.0, {true, false, false}));
  EXPECT_EQ(watch_.axes(), (std::array{true, false, false}));
}

TEST_F(StuckAccelerometerTest, SoAreAllThreeAtWalkingPace) {
  drive(5, 0.5);
  EXPECT_TRUE(drive(1, 0.5, {true, true, true}));
}

TEST_F(StuckAccelerometerTest, WhileItStandsACoarseOneMayRepeatItself) {
  drive(5, 3.0);
  EXPECT_FALSE(drive(60, 0.0, {true, true, true}));
  EXPECT_FALSE(drive(5, 3.0));
}

TEST_F(StuckAccelerometerTest, ItComesBackWhenItHasLivedForTwoSeconds) {
  drive(5, 3.0);
  drive(5, 3.0, {true, true, false});
  drive(1.5, 3.0);
  EXPECT_TRUE(watch_.stuck());
  drive(1.0, 3.0);
  EXPECT_FALSE(watch_.stuck());
}

}  // namespace
}  // namespace curbstone::ekf::inputs
