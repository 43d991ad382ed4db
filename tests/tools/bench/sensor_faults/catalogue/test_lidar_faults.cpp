#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "tests/tools/bench/sensor_faults/catalogue/fault_helpers.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

lidar_points_t many_points() {
  std::vector<SomePoint> points;
  for (int i = 0; i < 3200; ++i) {
    const float angle = 0.00196F * static_cast<float>(i), range = 2.0F + 0.01F * static_cast<float>(i);
    points.push_back({range * std::cos(angle), range * std::sin(angle), -1.0F});
  }
  return some_points(points);
}

double range_of(const lidar_points_t& m, std::size_t i) {
  return std::hypot(m.x[i], m.y[i], m.z[i]);
}

/// How many points differ from those of `other`.
int moved(const lidar_points_t& m, const lidar_points_t& other) {
  int n = 0;
  for (std::size_t i = 0; i < m.x.size(); ++i)
    n += m.x[i] != other.x[i] || m.y[i] != other.y[i] || m.z[i] != other.z[i] ? 1 : 0;
  return n;
}

TEST(LidarFaults, AMountTurnsThePointsAboutTheVertical) {
  const lidar_points_t m = after(fault_named("mount slips 5 deg"), some_points({{10, 0, -1}})).at(0);
  EXPECT_NEAR(m.x[0], 10 * std::cos(radians(5)), 1e-5);
  EXPECT_NEAR(m.y[0], 10 * std::sin(radians(5)), 1e-5);
  EXPECT_EQ(m.z[0], -1);
  const auto yaw = [](const char* name, double t) {
    const lidar_points_t turned = after(fault_named(name), some_points({{10, 0, -1}}), t).at(0);
    return double(std::atan2(turned.y[0], turned.x[0])) / radians(1);
  };
  EXPECT_NEAR(yaw("mount creeps", 17), 1, 1e-4);
  EXPECT_NEAR(yaw("mount creeps", 100), 20, 1e-4);
  EXPECT_NEAR(yaw("mount play 1.5 deg, 0.4 Hz", 15.5), 1.5, 1e-4);
  EXPECT_NEAR(yaw("mount play 1.5 deg, 0.4 Hz", 16.75), -1.5, 1e-4);
}

TEST(LidarFaults, StampsAreOff) {
  const auto utime = [](const char* name, double t) {
    return after(fault_named(name), some_points({{10, 0, -1}}, 10'000'000), t).at(0).utime - 10'000'000;
  };
  EXPECT_EQ(utime("LiDAR stamps late", 20), 60'000);
  EXPECT_EQ(utime("stamps of the revolution's end", 20), 50'000);
  EXPECT_EQ(utime("stamps of the revolution's start", 20), -50'000);
  EXPECT_EQ(utime("LiDAR clock set back", 20), -2'000'000);
  EXPECT_EQ(utime("LiDAR clock 1 % slow", 20), 50'000);
  EXPECT_EQ(utime("LiDAR clock 500 ppm slow", 20), 2'500);
}

TEST(LidarFaults, OneStampPerRevolution) {
  const Changes change = fault_named("one stamp per revolution").make();
  std::vector<std::int64_t> utimes;
  for (int i = 0; i < 6; ++i) {
    lidar_points_t m = some_points({{10, 0, -1}}, 1'000 * i);
    m.revolution = 7 + i / 3;
    change.lidar(0, m);
    utimes.push_back(m.utime);
  }
  EXPECT_THAT(utimes, ElementsAre(0, 0, 0, 3'000, 3'000, 3'000));
}

TEST(LidarFaults, GapsAndSilence) {
  const auto is_sent = [](const char* name, double t) {
    return !after(fault_named(name), some_points({{10, 0, -1}}), t).empty();
  };
  EXPECT_FALSE(is_sent("LiDAR gaps of 0.6 s", 20.3));
  EXPECT_TRUE(is_sent("LiDAR gaps of 0.6 s", 20.7));
  EXPECT_FALSE(is_sent("LiDAR gaps of 2 s", 17.5));
  EXPECT_TRUE(is_sent("LiDAR gaps of 2 s", 18.5));
  EXPECT_FALSE(is_sent("LiDAR silent", 20));
}

TEST(LidarFaults, RangesAreOffAndDirectionsAreNot) {
  const lidar_points_t before = some_points({{3, 4, 0}, {0, -5, 0}});
  const lidar_points_t longer = after(fault_named("ranges 10 cm long"), before).at(0);
  EXPECT_NEAR(range_of(longer, 0), 5.1, 1e-5);
  EXPECT_NEAR(longer.y[0] / longer.x[0], 4.0 / 3, 1e-5);
  EXPECT_NEAR(range_of(after(fault_named("ranges 8 cm short"), before).at(0), 1), 4.92, 1e-5);
  EXPECT_NEAR(range_of(after(fault_named("ranges off by direction"), before).at(0), 1), 4.94, 1e-5);
  const lidar_points_t steps = after(fault_named("ranges in steps of 20 cm"), some_points({{5.07F, 0, 0}})).at(0);
  EXPECT_NEAR(steps.x[0], 5.0, 1e-5);
  const lidar_points_t high = after(fault_named("elevations 8 % too large"), some_points({{10, 0, -1}})).at(0);
  EXPECT_NEAR(std::atan2(high.z[0], high.x[0]), 1.08 * std::atan2(-1, 10), 1e-6);
  EXPECT_NEAR(range_of(high, 0), std::hypot(10, 1), 1e-5);
}

TEST(LidarFaults, LasersAndIntensities) {
  const lidar_points_t before = many_points();
  EXPECT_EQ(after(fault_named("rings counted from above"), before).at(0).ring[3], 12);
  const lidar_points_t few = after(fault_named("three lasers of four dead"), before).at(0);
  EXPECT_EQ(few.num_points, 800);
  EXPECT_EQ(few.x.size(), 800U);
  EXPECT_EQ(few.x[1], before.x[4]);
  EXPECT_EQ(few.intensity[1], before.intensity[4]);
  EXPECT_EQ(few.time_offset[1], before.time_offset[4]);
  EXPECT_EQ(std::set(few.ring.begin(), few.ring.end()), (std::set<std::uint8_t>{0, 4, 8, 12}));
  EXPECT_THAT(after(fault_named("intensities 0"), before).at(0).intensity, Each(0));
  EXPECT_THAT(after(fault_named("intensities 255"), before).at(0).intensity, Each(255));
}

TEST(LidarFaults, APartOfThePointsIsSpoiled) {
  const lidar_points_t before = many_points();
  const auto share = [&](const char* name) {
    return moved(after(fault_named(name), before).at(0), before) / double(before.num_points);
  };
  EXPECT_NEAR(share("crosstalk"), 0.03, 0.01);
  EXPECT_NEAR(share("points NaN"), 0.01, 0.006);
  EXPECT_NEAR(share("points at 0"), 0.05, 0.015);
  EXPECT_NEAR(share("points far off"), 0.02, 0.01);
  EXPECT_NEAR(share("snow"), 0.08, 0.03);
}

TEST(LidarFaults, NothingIsSeenThere) {
  const lidar_points_t before = some_points({{4, 0, 0}, {-4, 0, 0}, {0, 9, 0}});
  const auto xs = [&](const char* name) { return after(fault_named(name), before).at(0).x; };
  EXPECT_THAT(xs("nothing ahead"), ElementsAre(-4, 0));
  EXPECT_THAT(xs("nothing behind"), ElementsAre(4));
  EXPECT_THAT(xs("nothing beyond 8 m"), ElementsAre(4, -4));
  EXPECT_NEAR(after(fault_named("half of the points"), many_points()).at(0).num_points, 1600, 100);
  const lidar_points_t fog = after(fault_named("fog"), many_points()).at(0);
  for (std::size_t i = 0; i < fog.x.size(); ++i) EXPECT_LT(range_of(fog, i), 18);
  const lidar_points_t drop = after(fault_named("drop on the window"), some_points({{4, 2.3F, 0}, {4, 0, 0}})).at(0);
  EXPECT_NEAR(range_of(drop, 0), 0.5, 1e-6);
  EXPECT_EQ(drop.x[1], 4);
}

TEST(SurroundingsFaults, ABusHidesWhatIsBehindItAndNothingElse) {
  // Behind the bus, before it, on the other side, above it.
  const lidar_points_t before = some_points({{0, 10, -1}, {0, 1.5F, -1}, {0, -10, -1}, {0, 10, 9}});
  const lidar_points_t m = after(fault_named("bus beside"), before).at(0);
  EXPECT_NEAR(m.y[0], 2.0, 0.1);
  EXPECT_NEAR(m.z[0], -0.2, 0.02);
  EXPECT_EQ(m.y[1], 1.5F);
  EXPECT_EQ(m.y[2], -10);
  EXPECT_EQ(m.y[3], 10);
  EXPECT_EQ(m.num_points, 4);
}

TEST(SurroundingsFaults, ThingsMove) {
  const auto x = [](const char* name, double t) {
    return after(fault_named(name), some_points({{20, 0, -0.5F}}), t).at(0).x[0];
  };
  EXPECT_NEAR(x("leader", 0), 8, 0.1);
  EXPECT_NEAR(x("leader", 6.283), 10, 0.1);
}

}  // namespace
}  // namespace curbstone::bench::sensor_faults::catalogue
