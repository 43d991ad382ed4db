#include "tools/bench/mapping/drives/poor_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::bench::mapping::drives {
namespace {

/// 2 m/s along x for 10 s.
evaluate::truth::Trajectory straight() {
  evaluate::truth::Trajectory truth;
  for (int i = 0; i <= 100; ++i) {
    Pose T = Pose::Identity();
    T.translation().x() = 0.2 * i;
    truth.push_back({1'000'000 + 100'000 * i, T});
  }
  return truth;
}

TEST(PoorOdometry, WithoutErrorsIsTheTruth) {
  const auto samples = poor_odometry(straight(), {1.0, 0.0}, 100'000);
  EXPECT_EQ(samples.front().utime, 900'000);
  EXPECT_GE(samples.back().utime, 11'000'000);
  for (const mapper::scan::OdometrySample& s : samples) {
    EXPECT_NEAR(s.T_odom_base.translation().x(), 2e-6 * static_cast<double>(s.utime - 900'000), 1e-9);
  }
}

TEST(PoorOdometry, StretchesAndTurns) {
  const auto samples = poor_odometry(straight(), {1.02, 0.01}, 0);
  const mapper::scan::OdometrySample& last = samples.back();
  const double seconds = 1e-6 * static_cast<double>(last.utime - samples.front().utime);
  EXPECT_NEAR(so3_log(Eigen::Quaterniond(last.T_odom_base.linear())).z(), 0.01 * seconds, 2e-4);
  const double radius = 1.02 * 2 / 0.01;  // it believes to drive on a circle
  EXPECT_NEAR(last.T_odom_base.translation().y(), radius * (1 - std::cos(0.01 * seconds)), 0.02);
}

}  // namespace
}  // namespace curbstone::bench::mapping::drives
