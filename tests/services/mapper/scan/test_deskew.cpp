#include "services/mapper/scan/deskew.hpp"

#include <gtest/gtest.h>

namespace curbstone::mapper::scan {
namespace {

const Pose kTBaseLidar = [] {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(0.3, -0.1, 1.7);
  T.linear() = rotation_from_rpy(0.02, -0.05, 0.4);
  return T;
}();

TEST(Twist, MoveAndTwistOfAreInverse) {
  const Twist twist{{3, 0.2, -0.1}, {0.1, -0.2, 1.5}};
  const Twist again = twist_of(move(twist, 0.1), 0.1);
  EXPECT_LT((again.linear - twist.linear).norm(), 1e-9);
  EXPECT_LT((again.angular - twist.angular).norm(), 1e-9);
}

TEST(Twist, HalfAMoveTwiceIsTheMove) {
  const Twist twist{{3, 0.2, -0.1}, {0.1, -0.2, 1.5}};
  EXPECT_TRUE((move(twist, 0.05) * move(twist, 0.05)).isApprox(move(twist, 0.1), 1e-12));
}

TEST(Deskew, IsExactForAConstantTwist) {
  const Twist twist{{8, 0.1, 0.05}, {0.05, -0.03, 1.2}};
  constexpr double kSweep = 0.1;
  std::vector<LidarPoint> seen;
  std::vector<Eigen::Vector3d> truth;  // in base_link at the end
  for (int i = 0; i < 1000; ++i) {
    const double time = kSweep * i / 1000;
    truth.emplace_back(30 * std::cos(0.01 * i), 30 * std::sin(0.01 * i), 0.003 * i);
    const Pose T_end_base = move(twist, time - kSweep);
    seen.push_back(
        {((T_end_base * kTBaseLidar).inverse() * truth.back()).cast<float>(), static_cast<float>(time), 7, 3});
  }
  const std::vector<LidarPoint> straight = deskew(seen, kTBaseLidar, steady_sweep(twist, kSweep));
  ASSERT_EQ(straight.size(), seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_LT((straight[i].position.cast<double>() - truth[i]).norm(), 1e-4) << i;
    EXPECT_EQ(straight[i].intensity, 7);
    EXPECT_EQ(straight[i].ring, 3);
  }
}

TEST(Deskew, OfAStandingVehicleOnlyChangesTheFrame) {
  const std::vector<LidarPoint> seen{{{1, 2, 3}, 0.05F, 0, 0}};
  const auto straight = deskew(seen, kTBaseLidar, steady_sweep({}, 0.1));
  EXPECT_LT((straight[0].position.cast<double>() - kTBaseLidar * Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
}

TEST(Deskew, TakesTimesOutsideTheSweepAsItsEnds) {
  const Twist twist{{10, 0, 0}, {0, 0, 0}};
  const std::vector<LidarPoint> seen{{{1, 0, 0}, -5.0F, 0, 0}, {{1, 0, 0}, 5.0F, 0, 0}};
  const auto straight = deskew(seen, Pose::Identity(), steady_sweep(twist, 0.1));
  EXPECT_NEAR(straight[0].position.x(), 0.0, 1e-5);
  EXPECT_NEAR(straight[1].position.x(), 1.0, 1e-5);
}

}  // namespace
}  // namespace curbstone::mapper::scan
