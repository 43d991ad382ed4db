#include "services/mapper/tracking/motion_prediction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace curbstone::mapper::tracking {
namespace {

scan::Scan at(double end) {
  scan::Scan scan;
  scan.end = std::llround(end * 1e6);
  scan.start = scan.end - 100'000;
  return scan;
}

TEST(MotionPrediction, ADriveMayBeginAtAnySpeedAndMostLikelyStands) {
  for (const double stride : {0.05, 0.1, 0.2}) {
    const std::vector<scan::Twist> motions = initial_motion_hypotheses(30, stride);
    EXPECT_EQ(motions.front().linear.norm(), 0);
    for (double speed = -3; speed <= 30 && speed * stride <= 5; speed += 0.5) {
      const bool near = std::any_of(motions.begin(), motions.end(), [&](const scan::Twist& motion) {
        return std::abs(motion.linear.x() - speed) * stride < 0.36;  // m, half way from one to the next
      });
      EXPECT_TRUE(near) << speed << " m/s, " << stride << " s";
    }
  }
}

TEST(MotionPrediction, NothingFasterThanAVehicleIsSought) {
  EXPECT_EQ(initial_motion_hypotheses(40, 0.001).size(), 1U);  // two scans that end at all but the same moment
  for (const scan::Twist& motion : initial_motion_hypotheses(30, 0.1)) EXPECT_LT(motion.linear.norm(), 30 + 3.6);
}

TEST(MotionPrediction, AfterAGapTheVehicleHasGoneOnButNotForEver) {
  const RecentMotion recent{at(10).end, {{8, 0, 0}, {0, 0, 0}}, 0.1};
  const auto ahead = [&](double end) {
    return predict_constant_velocity(recent, at(end)).T_last_base.translation().x();
  };
  EXPECT_NEAR(ahead(10.1), 0.8, 1e-9);
  EXPECT_NEAR(ahead(11.5), 12, 1e-9);
  EXPECT_NEAR(ahead(20), 0.8, 1e-9);
  EXPECT_FALSE(predict_constant_velocity(recent, at(10.1)).blind);
  EXPECT_TRUE(predict_constant_velocity(recent, at(11.5)).blind);
}

}  // namespace
}  // namespace curbstone::mapper::tracking
