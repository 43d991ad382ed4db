#include <gtest/gtest.h>

#include <limits>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using Drive = test::MapperDrive;

/// What no LiDAR and no network should do, to either method. Whatever comes: no crash, it is counted, the map stays
/// what it was, and the drive goes on.
class BadInput : public testing::TestWithParam<const char*> {
 protected:
  BadInput() : drive_(GetParam()) {
    drive_.with_odometry(20);
    for (int i = 0; i < 20; ++i) (void)drive_.step();
    keyframes_ = counter("keyframes");
    points_ = drive_.dense().size();
  }
  [[nodiscard]] std::int64_t counter(const char* name) const { return drive_.mapper->counters()[name]; }
  void expect_map_unchanged() {
    EXPECT_EQ(counter("keyframes"), keyframes_);
    EXPECT_EQ(drive_.dense().size(), points_);
  }
  /// It shows nothing, and odometry tells where the vehicle is.
  void expect_led_by_odometry(const scan::Scan& nothing) {
    const auto update = drive_.step(nothing);
    ASSERT_TRUE(update && !update->registered);
    EXPECT_LT(drive_.error(*update), 0.03);
    EXPECT_EQ(counter("refused.sparse"), 1);
  }
  void expect_to_go_on() {
    std::optional<MapperUpdate> update;
    for (int i = 0; i < 3; ++i) update = drive_.step();
    ASSERT_TRUE(update && update->registered);
    EXPECT_LT(drive_.error(*update), 0.03);
  }

  Drive drive_;
  std::int64_t keyframes_ = 0;
  std::int64_t points_ = 0;
};

TEST_P(BadInput, TheSameScanAgain) {
  --drive_.turn;
  const scan::Scan again = drive_.next();
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(drive_.step(again));
  EXPECT_EQ(counter("refused.time"), 3);
  expect_map_unchanged();
  expect_to_go_on();
}

TEST_P(BadInput, AnOldScanLate) {
  drive_.turn -= 6;
  const scan::Scan old = drive_.next();
  drive_.turn += 5;
  EXPECT_FALSE(drive_.step(old));
  EXPECT_EQ(counter("refused.time"), 1);
  expect_map_unchanged();
  expect_to_go_on();
}

TEST_P(BadInput, ScansAreMissing) {
  for (const int missing : {1, 5, 25}) {
    drive_.turn += missing;
    expect_to_go_on();
  }
}

TEST_P(BadInput, HalfAScanIsRegisteredAsWell) {
  for (int i = 0; i < 4; ++i) {
    scan::Scan half = drive_.next();
    const auto middle = half.points.begin() + static_cast<std::ptrdiff_t>(half.points.size() / 2);
    if (i % 2 == 0) {
      half.points.erase(middle, half.points.end());
    } else {
      half.points.erase(half.points.begin(), middle);
    }
    const auto update = drive_.step(half);
    ASSERT_TRUE(update);
    EXPECT_LT(drive_.error(*update), 0.04);
  }
  expect_to_go_on();
}

TEST_P(BadInput, AllReturnsAtZero) {
  scan::Scan zero = drive_.next();
  for (scan::LidarPoint& p : zero.points) p.position.setZero();
  expect_led_by_odometry(zero);
  expect_map_unchanged();
  expect_to_go_on();
}

TEST_P(BadInput, PointsThatAreNotNumbersAreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  scan::Scan some = drive_.next();
  for (std::size_t i = 0; i < some.points.size(); i += 7) {
    some.points[i].position[static_cast<int>(i % 3)] = i % 2 == 0 ? kNan : kInfinity;
    if (i % 5 == 0) some.points[i].time = kNan;
  }
  const auto update = drive_.step(some);
  ASSERT_TRUE(update && update->registered);
  EXPECT_LT(drive_.error(*update), 0.03);
  keyframes_ = counter("keyframes");
  points_ = drive_.dense().size();
  scan::Scan all = drive_.next();
  for (scan::LidarPoint& p : all.points) p.position.x() = kNan;
  expect_led_by_odometry(all);
  expect_map_unchanged();
  expect_to_go_on();
}

TEST_P(BadInput, AScanThatLastedForYearsOrEndedBeforeItBegan) {
  scan::Scan years = drive_.next();
  years.start = 0;
  EXPECT_FALSE(drive_.step(years));
  scan::Scan backwards = drive_.next();
  std::swap(backwards.start, backwards.end);
  EXPECT_FALSE(drive_.step(backwards));
  EXPECT_EQ(counter("refused.time"), 2);
  expect_map_unchanged();
  expect_to_go_on();
}

TEST_P(BadInput, TheClockJumpsThereAndBack) {
  for (const std::int64_t jump : {-7'200'000'000LL, 7'200'000'000LL}) {
    scan::Scan elsewhen = drive_.next();
    elsewhen.start += jump;
    elsewhen.end += jump;
    (void)drive_.step(elsewhen);
    (void)drive_.step();
    expect_to_go_on();
  }
}

TEST_P(BadInput, ScansFromAnotherPlaceForAWhile) {
  test::SyntheticWorld elsewhere;  // a narrow yard
  elsewhere.boxes = {
      {{-3, -3, 0}, {-2, 3, 4}}, {{2.2, -3, 0}, {3, 3, 4}}, {{-3, 2.5, 0}, {3, 3, 4}}, {{-3, -3.4, 0}, {3, -2.1, 4}}};
  for (int i = 0; i < 12; ++i) {
    const int n = drive_.turn++;
    const auto update = drive_.step(
        test::scan_of(elsewhere.packets([](double) { return test::pose(0, 0, 0, 0, 0, 0.7); },
                                        drive_.config.vehicle.T_base_lidar(), n, n * test::kPeriod, test::kPeriod)));
    ASSERT_TRUE(update);
    EXPECT_FALSE(update->registered) << i;
    EXPECT_LT(drive_.error(*update), 0.05) << i;  // by odometry
  }
  EXPECT_EQ(drive_.mapper->refused_in_a_row(), 12);
  expect_map_unchanged();
  expect_to_go_on();
}

INSTANTIATE_TEST_SUITE_P(Mapper, BadInput, testing::Values("icp", "loam"),
                         [](const auto& method) { return std::string(method.param); });

}  // namespace
}  // namespace curbstone::mapper
