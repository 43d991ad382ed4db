#include "services/mapper/tracking/motion_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr double kScanPeriod = 0.1;         // s
constexpr double kAge = 0.5 * kScanPeriod;  // s: points all through the revolution
const scan::Twist kBend{{8, 0, 0}, {0, 0, 0.4}};

/// What registration finds of a revolution that was de-skewed with `assumed`: the middle is where it was.
MotionFilter::Found found_by(const Pose& T_last_middle, const scan::Twist& assumed) {
  return {T_last_middle * scan::move(assumed, kAge), assumed, kAge, kScanPeriod};
}

/// How far along x each end is found off, m, when the motion is steady within each revolution and the first end is
/// thought to be off by `first`.
std::vector<double> errors(const std::vector<scan::Twist>& twists, double first = 0) {
  MotionFilter filter;
  filter.set(twists.front());
  Pose truth = Pose::Identity();
  Pose thought = test::pose(first, 0, 0, 0, 0, 0);
  std::vector<double> out;
  for (const scan::Twist& twist : twists) {
    const Pose middle = truth * scan::move(twist, kScanPeriod - kAge);
    truth = truth * scan::move(twist, kScanPeriod);
    thought = normalised(thought * filter.take(found_by(thought.inverse() * middle, filter.twist())));
    out.push_back((truth.inverse() * thought).translation().x());
  }
  return out;
}

TEST(MotionFilter, KeepsASteadyMotion) {
  for (const double error : errors(std::vector<scan::Twist>(50, kBend))) EXPECT_NEAR(error, 0, 1e-9);
}

TEST(MotionFilter, DoesNotSwingWithTheErrorOfOneEnd) {
  const scan::Twist straight{{8, 0, 0}, {0, 0, 0}};
  const std::vector<double> left = errors(std::vector<scan::Twist>(6, straight), 0.10);
  EXPECT_NEAR(left[0], -0.10 * MotionFilter::kShare, 1e-9);
  for (std::size_t i = 1; i < left.size(); ++i)
    EXPECT_NEAR(left[i], (1 - 2 * MotionFilter::kShare) * left[i - 1], 1e-9) << i;
  EXPECT_LT(std::abs(left.back()), 1e-4);
}

TEST(MotionFilter, IsLittleBehindAMotionThatChanges) {
  constexpr double kChange = 0.3;  // m/s each revolution: 3 m/s^2
  std::vector<scan::Twist> twists;
  for (int i = 0; i < 40; ++i) twists.push_back({{2 + kChange * i, 0, 0}, {0, 0, 0}});
  const double behind = (1 - MotionFilter::kShare) / (4 * MotionFilter::kShare) * kChange * kScanPeriod;
  EXPECT_NEAR(errors(twists).back(), -behind, 1e-6);
  EXPECT_LT(behind, 0.006);
}

TEST(MotionFilter, DoesNotMindWhatWasAssumed) {
  const Pose T_last_middle = scan::move(kBend, kScanPeriod - kAge);
  MotionFilter right, wrong;
  for (MotionFilter* filter : {&right, &wrong}) filter->set({{6, 0, 0}, {0, 0, 0.2}});
  const Pose a = right.take(found_by(T_last_middle, kBend));
  const Pose b = wrong.take(found_by(T_last_middle, {{3, 1, 0}, {0, 0.1, 0}}));
  EXPECT_TRUE(a.isApprox(b, 1e-9));
  EXPECT_NEAR(right.twist().linear.x(), wrong.twist().linear.x(), 1e-9);
}

TEST(MotionFilter, TakesAScanOfOneMomentAsItIs) {
  MotionFilter filter;
  filter.set({{6, 0, 0}, {0, 0, 0}});
  const Pose found = scan::move(kBend, kScanPeriod);
  EXPECT_TRUE(filter.take({found, {}, 0, kScanPeriod}).isApprox(found, 1e-12));
  EXPECT_NEAR(filter.twist().linear.x(), 6 + MotionFilter::kShare * 2, 0.05);
}

TEST(MotionFilter, DoesNotLeapWhereAScanHardlyFollowsTheLast) {
  MotionFilter filter;
  filter.set({{6, 0, 0}, {0, 0, 0}});
  (void)filter.take({test::pose(0.01, 0, 0, 0, 0, 0), filter.twist(), kAge, 0.001});
  EXPECT_NEAR(filter.twist().linear.x(), 6, 0.3);
  (void)filter.take({test::pose(0.01, 0, 0, 0, 0, 0), filter.twist(), kAge, kAge});
  EXPECT_TRUE(std::isfinite(filter.twist().linear.x()));
}

}  // namespace
}  // namespace curbstone::mapper::tracking
