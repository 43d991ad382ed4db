#include "services/ekf/detection/standing_motion.hpp"

#include <gtest/gtest.h>

#include <random>

namespace curbstone::ekf::detection {
namespace {

constexpr double kStep = 0.01;  // s

struct Stand {
  StandingMotion motion;
  Eigen::Vector3d gravity{0.2, -0.1, 9.8};  // m/s^2, tilted, with a bias
  std::mt19937 random{1};
  /// Accelerates by `forward` and turns at `rate` for `seconds`. When it is found to drive, s; -1 if it is not.
  double run(double seconds, double forward, const Eigen::Vector3d& rate = Eigen::Vector3d::Zero()) {
    std::normal_distribution<double> noise(0, 0.05);
    for (double t = 0; t < seconds; t += kStep) {
      gravity -= kStep * rate.cross(gravity);
      const Eigen::Vector3d felt = gravity + Eigen::Vector3d(forward + noise(random), noise(random), noise(random));
      if (motion.add(felt, rate, kStep)) return t;
    }
    return -1;
  }
};

TEST(StandingMotionTest, AGentleStartIsFoundWithinASecond) {
  Stand stand;
  EXPECT_EQ(stand.run(5, 0), -1);
  const double found = stand.run(3, 0.5);
  EXPECT_GT(found, 0.3);
  EXPECT_LT(found, 1.1);
}

TEST(StandingMotionTest, BackwardsToo) {
  Stand stand;
  EXPECT_EQ(stand.run(5, 0), -1);
  EXPECT_GT(stand.run(3, -0.5), 0);
}

TEST(StandingMotionTest, HoursOfStandingAreNone) {
  Stand stand;
  for (int second = 0; second < 3600; ++second) {
    ASSERT_EQ(stand.run(1, 0), -1);
    ASSERT_EQ(stand.motion.suspected_speed(), 0.0) << second;
  }
}

TEST(StandingMotionTest, AStartIsSuspectedBeforeItIsFound) {
  Stand stand;
  EXPECT_EQ(stand.run(5, 0), -1);
  EXPECT_EQ(stand.run(0.3, 0.5), -1);
  EXPECT_NEAR(stand.motion.suspected_speed(), 0.15, 0.05);
  EXPECT_GT(stand.run(3, 0.5), 0);
  EXPECT_EQ(stand.motion.suspected_speed(), 0.0) << "what was found is the filter's";
}

TEST(StandingMotionTest, ABlowIsForgotten) {
  Stand stand;
  EXPECT_EQ(stand.run(5, 0), -1);
  EXPECT_EQ(stand.run(0.04, 5), -1);
  EXPECT_GT(stand.motion.suspected_speed(), 0.1);
  EXPECT_EQ(stand.run(3, 0), -1);
  EXPECT_EQ(stand.motion.suspected_speed(), 0.0);
}

/// Somebody climbs on, or it is jacked up: the gyro tells.
TEST(StandingMotionTest, TiltingIsNone) {
  Stand stand;
  EXPECT_EQ(stand.run(5, 0), -1);
  EXPECT_EQ(stand.run(3, 0, {0, 0.04, 0}), -1);
  EXPECT_EQ(stand.run(20, 0), -1);
}

}  // namespace
}  // namespace curbstone::ekf::detection
