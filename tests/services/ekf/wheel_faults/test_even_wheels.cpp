#include "services/ekf/wheel_faults/even_wheels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace curbstone::ekf::wheel_faults {
namespace {

constexpr std::int64_t kInterval = 50'000;  // us

/// Whether wheels that turn at 3 m/s for 20 s are found to be made up, beside an IMU whose speed is the given function
/// of s, and which walks by `walk` m/s/sqrt(s).
template <class Speed>
bool finds_made_up(Speed speed, double walk, double told_noise, unsigned seed = 1) {
  EvenWheels wheels;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  double astray = 0.0;
  bool found = false;
  for (int i = 0; i < 400; ++i) {
    const double seconds = 1e-6 * kInterval;
    astray += walk * std::sqrt(seconds) * normal(engine);
    wheels.add({kInterval * i, kInterval * (i + 1), {3.0, 3.0}}, speed(seconds * i) + astray, told_noise);
    found |= wheels.made_up();
  }
  return found;
}

double even(double /*t*/) {
  return 3.0;
}

/// From 8 s on to a stop.
double brakes(double t) {
  return std::clamp(3.0 - (t - 8.0), 0.0, 3.0);
}

TEST(EvenWheels, AreMadeUpWhereTheImuBrakesAndTheyDoNot) {
  EXPECT_TRUE(finds_made_up(brakes, 0.0, 0.0));
  EXPECT_FALSE(finds_made_up(even, 0.0, 0.0));
}

TEST(EvenWheels, AreNotForWhatTheImusNoiseAddsUpTo) {
  int blamed_untold = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    blamed_untold += finds_made_up(even, 0.3, 0.0, seed) ? 1 : 0;
    EXPECT_FALSE(finds_made_up(even, 0.3, 0.3, seed)) << seed;
  }
  EXPECT_GT(blamed_untold, 10);  // else this test shows nothing
}

TEST(EvenWheels, AreFoundBesideAnImuOfFiveTimesTheUsualNoise) {
  EXPECT_TRUE(finds_made_up(brakes, 0.05, 0.05));
}

}  // namespace
}  // namespace curbstone::ekf::wheel_faults
