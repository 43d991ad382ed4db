#include "services/mapper/moving_objects/co_moving_objects.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/mounting/avenue.hpp"
#include "tests/services/mapper/moving_objects/companion.hpp"

namespace curbstone::mapper::moving_objects {
namespace {

using test::kPeriod;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Pose straight(double t) {
  return test::pose(-20 + 3 * t, 0, 0, 0, 0, 0);
}

Pose standing(double) {
  return test::pose(0, 0, 0, 0, 0, 0);
}

/// Revolutions of a LiDAR on a vehicle that drives along `trajectory`, or believes so.
struct Watch {
  test::SyntheticWorld world = test::street();
  test::SyntheticWorld::Trajectory trajectory = straight;
  scan::OdometryHistory odometry;
  CoMovingObjects objects{VehicleConfig{}};
  int turn = 0;

  void believe(const test::SyntheticWorld::Trajectory& way, double until = 20) {
    for (double t = -0.05; t < until; t += 0.01) odometry.add({test::utime(t), way(0).inverse() * way(t), true, false});
  }
  /// The next revolution, and what is left of it.
  struct Look {
    scan::Scan scan;
    std::optional<scan::Scan> rest;
  };
  Look look(const std::function<void(scan::Scan&)>& change = {}) {
    const int n = turn++;
    Look look{test::scan_of(world.packets(trajectory, test::default_lidar(), n, n * kPeriod, kPeriod)), {}};
    if (change) change(look.scan);
    look.rest = objects.without(look.scan, odometry);
    return look;
  }
  void until(double end, const std::function<void(scan::Scan&)>& change = {}) {
    while (turn * kPeriod < end) (void)look(change);
  }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    objects.add_faults(faults);
    return faults;
  }
};

void with_bus(scan::Scan& scan) {
  test::put_companion(test::bus(), scan);
}

/// Number of points on the side of the bus.
std::ptrdiff_t on_bus(const scan::Scan& scan) {
  return std::count_if(scan.points.begin(), scan.points.end(), [](const scan::LidarPoint& point) {
    const Eigen::Vector3f& p = point.position;
    return std::abs(p.y() - 2) < 0.1F && std::abs(p.x()) < 6 && p.z() > -1;
  });
}

TEST(CoMovingObjects, ABusAtTheSameSpeedIsLeftOutOfARevolution) {
  Watch watch;
  watch.believe(straight);
  watch.until(4, with_bus);
  const Watch::Look look = watch.look(with_bus);
  ASSERT_GT(on_bus(look.scan), 1000);
  ASSERT_TRUE(look.rest);
  EXPECT_LT(on_bus(*look.rest), 0.02 * static_cast<double>(on_bus(look.scan)));
  EXPECT_GT(look.rest->points.size(), look.scan.points.size() / 3) << "the rest of the street stays";
  EXPECT_NEAR(watch.objects.hidden(), 144, 12);
  EXPECT_EQ(watch.objects.counters()["co_moving"], 1);
}

TEST(CoMovingObjects, OneThatStaysForTenSecondsIsReported) {
  Watch watch;
  watch.believe(straight);
  watch.until(8, with_bus);
  EXPECT_THAT(watch.faults(), IsEmpty());
  watch.until(14, with_bus);
  EXPECT_THAT(watch.faults(), Contains(HasSubstr("something that moves with the vehicle hides 1")));
}

TEST(CoMovingObjects, ABusThatFallsBackIsForgotten) {
  Watch watch;
  watch.believe(straight);
  watch.until(4, with_bus);
  ASSERT_GT(watch.objects.hidden(), 100);
  watch.until(6);
  EXPECT_EQ(watch.objects.hidden(), 0);
  EXPECT_FALSE(watch.look().rest);
}

TEST(CoMovingObjects, ABusThatWaitsBesideTheVehicleIsStillKnownAfterwards) {
  Watch watch;
  watch.trajectory = [](double t) { return straight(std::min(t, 4.0)); };
  watch.believe(watch.trajectory);
  watch.until(9, with_bus);
  EXPECT_NEAR(watch.objects.hidden(), 144, 12);
}

TEST(CoMovingObjects, WhatABusHidesAtAStandstillIsNotKnown) {
  Watch watch;
  watch.trajectory = standing;
  watch.believe(standing);
  watch.until(6, with_bus);
  EXPECT_EQ(watch.objects.hidden(), 0);
}

/// Streets with much that keeps its range while the vehicle drives along.
class AStreet : public ::testing::TestWithParam<test::SyntheticWorld> {};

TEST_P(AStreet, IsLeftAsItIs) {
  for (const test::SyntheticWorld::Trajectory& way :
       {test::SyntheticWorld::Trajectory(straight), test::SyntheticWorld::Trajectory(test::driving)}) {
    Watch watch;
    watch.world = GetParam();
    watch.world.noise = 0.02;
    watch.trajectory = way;
    watch.believe(way);
    watch.until(12);
    EXPECT_EQ(watch.objects.counters()["co_moving"], 0);
  }
}

/// Houses of `length` m with gaps of `gap` between them on both sides, `height` m high, and a front behind the gaps.
test::SyntheticWorld row(double length, double gap, double height, double aside = 5) {
  test::SyntheticWorld world;
  for (double x = -60; x < 80; x += length + gap) {
    world.boxes.push_back({{x, aside, 0}, {x + length, aside + 2, height}});
    world.boxes.push_back({{x, -aside - 2, 0}, {x + length, -aside, height}});
  }
  world.boxes.push_back({{-60, 15, 0}, {80, 16, 8}});
  world.boxes.push_back({{-60, -16, 0}, {80, -15, 8}});
  return world;
}

INSTANTIATE_TEST_SUITE_P(CoMovingObjects, AStreet,
                         ::testing::Values(test::street(), test::tunnel(), row(10, 6, 6), row(3, 3, 6),
                                           row(1.5, 1.5, 3), row(0.4, 2.6, 4), row(10, 6, 1.1), row(10, 6, 0.8),
                                           row(4.5, 1, 1.5, 3), row(10, 3, 6, 2.5)));

TEST(CoMovingObjects, WheelsThatSpinDoNotMakeTheStreetMove) {
  Watch watch;
  watch.trajectory = standing;
  watch.believe(straight);
  watch.until(8);
  EXPECT_EQ(watch.objects.hidden(), 0);
}

TEST(CoMovingObjects, WithoutOdometryNothingIsLeftOut) {
  Watch watch;
  watch.until(6, with_bus);
  EXPECT_EQ(watch.objects.hidden(), 0);
}

TEST(CoMovingObjects, WhereOdometryEndsWhatWasKnownIsForgotten) {
  Watch watch;
  watch.believe(straight, 5);
  watch.until(4, with_bus);
  ASSERT_GT(watch.objects.hidden(), 100);
  watch.until(6, with_bus);
  EXPECT_EQ(watch.objects.hidden(), 0);
}

TEST(CoMovingObjects, AClockThatIsSetBackIsANewBeginning) {
  Watch watch;
  watch.believe(straight);
  watch.until(4, with_bus);
  watch.turn = 20;  // 3 s back
  (void)watch.look(with_bus);
  EXPECT_EQ(watch.objects.hidden(), 0);
  watch.until(5, with_bus);
  EXPECT_GT(watch.objects.hidden(), 100);
}

/// The whole mapper in an avenue that winds, between two lorries that turn with the vehicle.
TEST(MapperBetweenLorries, FollowsTheStreetInBends) {
  test::MapperDrive drive;
  drive.world = test::avenue(45);
  drive.world.noise = 0.01;
  drive.trajectory = [](double t) {
    return test::pose(-8 + 3 * t, 1.5 * (1 - std::cos(0.6 * t)), 0, 0, 0, std::atan(0.3 * std::sin(0.6 * t)));
  };
  drive.with_odometry(16);
  double error = 0;
  while (drive.turn * kPeriod < 14) {
    scan::Scan scan = drive.next();
    if (drive.turn * kPeriod > 2) {
      test::put_companion(test::bus(), scan);
      test::put_companion({Eigen::Vector3f(-8, -4.5F, -1.7F), Eigen::Vector3f(8, -2, 1.3F)}, scan);
    }
    const auto update = drive.step(scan);
    ASSERT_TRUE(update);
    error = std::max(error, drive.error(*update));
  }
  EXPECT_LT(error, 0.05);
  EXPECT_EQ(drive.mapper->counters()["refused.turn"], 0);
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kTracking);
}

}  // namespace
}  // namespace curbstone::mapper::moving_objects
