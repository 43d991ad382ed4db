#include "services/mapper/intensity/ring_scale.hpp"

#include <gtest/gtest.h>

namespace curbstone::mapper::intensity {
namespace {

Pose at(double x) {
  return Pose(Eigen::Translation3d(x, 0, 0));
}

/// Of two rings, points in the strip ahead; beside it, above it and too near, others of other intensities.
std::vector<scan::LidarPoint> view(int turn) {
  std::vector<scan::LidarPoint> points;
  for (int i = 0; i < 60; ++i) {
    const auto y = 0.03F * static_cast<float>(i - 30);
    const auto ripple = static_cast<std::uint8_t>((i + turn) % 9);
    for (const auto ring : {std::uint8_t{0}, std::uint8_t{1}}) {
      const auto value = static_cast<std::uint8_t>(ring == 0 ? 20 + ripple : 100 + 4 * ripple);
      points.push_back({{7.0F, y, 0.02F}, 0, value, ring});
      points.push_back({{-7.0F, y, -0.02F}, 0, value, ring});
      points.push_back({{7.0F, y + 5, 0.02F}, 0, 250, ring});    // beside
      points.push_back({{12.0F, y, 1.0F}, 0, 250, ring});        // a car
      points.push_back({{1.0F, 0.5F * y, 0.0F}, 0, 250, ring});  // the vehicle's own
    }
  }
  return points;
}

TEST(RingScale, IsLearnedOfTheRoadThatIsDriven) {
  RingScale scale;
  EXPECT_EQ(scale.table()->of(0, 24), 0) << "nothing is known yet";
  for (int i = 0; i < 10; ++i) scale.learn(view(i), at(0));
  EXPECT_NEAR(scale.table()->of(0, 24), 64, 2);
  EXPECT_NEAR(scale.table()->of(1, 116), 64, 2);
  EXPECT_EQ(scale.table()->of(2, 116), 0) << "a ring that sees no road";
  EXPECT_EQ(scale.counters()["intensity.tables"], 1);
}

TEST(RingScale, TakesNoMoreFromOnePlaceAndIsMadeAnewAfterEachDoubling) {
  RingScale scale;
  for (int i = 0; i < 50; ++i) scale.learn(view(i), at(0));
  EXPECT_EQ(scale.basis().scans, 10);
  for (int i = 0; i < 2000; ++i) scale.learn(view(i), at(0.1 * i));
  EXPECT_EQ(scale.basis().scans, 640);
  EXPECT_EQ(scale.counters()["intensity.tables"], 7);
  for (int i = 0; i < 4000; ++i) scale.learn(view(i), at(300 + 0.3 * i));
  EXPECT_EQ(scale.basis().scans, 1280) << "and then it stands";
}

TEST(RingScale, GoesOnWhereAnotherLeftOff) {
  RingScale first, second;
  for (int i = 0; i < 100; ++i) first.learn(view(i), at(0.3 * i));
  second.restore(first.basis());
  EXPECT_EQ(second.basis(), first.basis());
  for (int raw = 0; raw < 256; ++raw)
    EXPECT_EQ(second.table()->of(1, static_cast<std::uint8_t>(raw)),
              first.table()->of(1, static_cast<std::uint8_t>(raw)));
  for (int i = 1; i <= 80; ++i) second.learn(view(i), at(0.3 * i));
  EXPECT_EQ(second.basis().scans, 160);
}

}  // namespace
}  // namespace curbstone::mapper::intensity
