#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/motion/speed_profile.hpp"

namespace curbstone::simulate::motion {
namespace {

TEST(SpeedProfile, StandsThenDrivesThenStopsAndDrivesOn) {
  const motion::SpeedProfile profile({}, 60);
  EXPECT_EQ(profile.speed(3.9), 0);
  EXPECT_DOUBLE_EQ(profile.speed(20), 3.0);
  EXPECT_NEAR(profile.speed(36.5), 0.0, 1e-9) << "the stop in between";
  EXPECT_DOUBLE_EQ(profile.speed(50), 3.0);
}

void expect_integrals(const motion::SpeedProfile::Options& options) {
  const motion::SpeedProfile profile(options, 100);
  double way = 0, speed = 0;
  constexpr double kStep = 1e-3;
  for (int i = 0; i < 100'000; ++i) {
    const double t = (i + 0.5) * kStep;
    way += profile.speed(t) * kStep;
    speed += profile.acceleration(t) * kStep;
    ASSERT_NEAR(profile.speed((i + 1) * kStep), speed, 1e-5);
    ASSERT_NEAR(profile.distance((i + 1) * kStep), way, 1e-4);
    ASSERT_LE(std::abs(profile.acceleration(t)), options.acceleration + 1e-9);
  }
}

TEST(SpeedProfile, DistanceIsTheIntegralOfSpeedAndSpeedThatOfAcceleration) {
  expect_integrals({});
}

TEST(SpeedProfile, ABrakingBeginsOnlyOnceItIsAsFastAsItShallBe) {
  motion::SpeedProfile::Options gentle;
  gentle.speed = 10;
  gentle.acceleration = 0.3;
  expect_integrals(gentle);
}

TEST(SpeedProfile, BacksUpAtItsFirstStopAndDrivesOn) {
  motion::SpeedProfile::Options options;
  options.manoeuvres = true;
  expect_integrals(options);
  const motion::SpeedProfile profile(options, 100);
  double slowest = 0, back = 0;
  for (double t = 0; t < 100; t += 0.01) {
    slowest = std::min(slowest, profile.speed(t));
    back += std::max(0.0, -profile.speed(t)) * 0.01;
  }
  EXPECT_NEAR(slowest, -1.0, 1e-6);
  EXPECT_NEAR(back, 8.0, 0.01) << "m";
}

TEST(SpeedProfile, StandsForGoodAfterItsDistance) {
  for (const double distance : {20.0, 80.0, 100.0, 155.0, 1000.0}) {
    motion::SpeedProfile::Options options;
    options.distance = distance;
    const motion::SpeedProfile profile(options, 1e9);
    EXPECT_NEAR(profile.distance(profile.end()), distance, 1e-9);
    EXPECT_NEAR(profile.speed(profile.end()), 0, 1e-12);
    EXPECT_NEAR(profile.distance(profile.end() + 1000), distance, 1e-9);
    EXPECT_GT(profile.speed(profile.end() - 0.5), 0);
  }
}

}  // namespace
}  // namespace curbstone::simulate::motion
