#include "services/mapper/detection/turn_sense.hpp"

#include <gtest/gtest.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::detection {
namespace {

/// Twenty revolutions a second, registered to half a milliradian; `by_scans`: the registered yaw, of odometry's.
template <class ByScans>
bool is_opposite_after(double seconds, ByScans by_scans) {
  TurnSense sense;
  for (int i = 0; i < 20 * seconds; ++i) {
    const double t = 0.05 * i, yaw = 0.05 * std::sin(0.8 * t);  // a driver who does not quite keep straight on
    const double noise = 0.001 * (test::chance(static_cast<std::uint64_t>(i)) - 0.5);
    sense.add(test::utime(t), test::pose(3 * t, 0, 0, 0, 0, by_scans(yaw) + noise), test::pose(3 * t, 0, 0, 0, 0, yaw));
  }
  return sense.is_opposite();
}

TEST(TurnSense, MirroredAzimuthsShowBeforeTheFirstBend) {
  EXPECT_TRUE(is_opposite_after(10, [](double yaw) { return -yaw; }));
}

TEST(TurnSense, OtherErrorsDoNot) {
  EXPECT_FALSE(is_opposite_after(60, [](double yaw) { return yaw; }));
  EXPECT_FALSE(is_opposite_after(60, [](double yaw) { return 0.5 * yaw; }));
  EXPECT_FALSE(is_opposite_after(60, [](double) { return 0.0; }));
}

TEST(TurnSense, StraightOnItSaysNothing) {
  EXPECT_FALSE(is_opposite_after(60, [](double) { return 0.0; }));
  TurnSense sense;
  for (int i = 0; i < 2000; ++i) {
    const double noise = 0.004 * (test::chance(static_cast<std::uint64_t>(i)) - 0.5);
    sense.add(test::utime(0.05 * i), test::pose(0, 0, 0, 0, 0, -noise), test::pose(0, 0, 0, 0, 0, noise));
  }
  EXPECT_FALSE(sense.is_opposite());
}

}  // namespace
}  // namespace curbstone::mapper::detection
