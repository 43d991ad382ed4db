#include <gtest/gtest.h>

#include "services/mapper/mapper.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::kPeriod;
using test::scan_of;
using test::utime;

/// A street that looks different wherever one is.
test::SyntheticWorld street_with_a_kiosk() {
  test::SyntheticWorld world = test::street();
  world.boxes.push_back({{-16, 3, 0}, {-13, 6, 3}});  // a kiosk
  world.boxes.push_back({{2, -8, 0}, {4, -6, 2.2}});  // a container
  return world;
}

test::SyntheticWorld yard() {
  test::SyntheticWorld world;
  world.boxes = {
      {{-3, -3, 0}, {-2, 3, 4}}, {{2.2, -3, 0}, {3, 3, 4}}, {{-3, 2.5, 0}, {3, 3, 4}}, {{-3, -3.4, 0}, {3, -2.1, 4}}};
  return world;
}

struct LostDrive : test::MapperDrive {
  LostDrive() {
    world = street_with_a_kiosk();
    world.noise = 0.01;
  }
  void with_odometry(double until) { MapperDrive::with_odometry(until); }
  /// Only between these times, s; in a frame that has moved since.
  void with_odometry(double from, double until, const Pose& T_new_old = Pose::Identity()) {
    for (double t = from; t < until; t += 0.01)
      odometry.add({utime(t), T_new_old * trajectory(0).inverse() * trajectory(t), true, false});
  }
  std::optional<MapperUpdate> steps(int n) {
    std::optional<MapperUpdate> update;
    for (int i = 0; i < n; ++i) update = step();
    return update;
  }
  std::optional<MapperUpdate> step_in(const test::SyntheticWorld& elsewhere) {
    const int n = turn++;
    return step(test::scan_of(elsewhere.packets([](double) { return test::pose(0, 0, 0, 0, 0, 0.7); },
                                                config.vehicle.T_base_lidar(), n, n * test::kPeriod, test::kPeriod)));
  }
  [[nodiscard]] std::int64_t counter(const char* name) const { return mapper->counters()[name]; }
};

TEST(MapperLost, AfterSecondsWithoutAnySensorTheVehicleIsSoughtAndNothingIsMappedUntilItIsFound) {
  LostDrive drive;
  (void)drive.steps(40);
  const std::int64_t points = drive.dense().size();
  drive.turn += 40;  // 2 s, 6 m
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 40 && drive.counter("found") == 0; ++i) {
    update = drive.step();
    if (!update) continue;
    if (update->fix != tracking::Fix::kTracking) {
      EXPECT_EQ(drive.dense().size(), points) << i;
    }
    if (update->registered) {
      EXPECT_LT(drive.error(*update), 0.1) << i;
    }
  }
  EXPECT_EQ(drive.counter("lost.blind"), 1);
  EXPECT_EQ(drive.counter("found"), 1);
  EXPECT_EQ(drive.counter("rolled_back"), 0);
  update = drive.steps(10);
  ASSERT_TRUE(update && update->registered);
  EXPECT_LT(drive.error(*update), 0.08);
  EXPECT_GT(drive.dense().size(), points);
}

TEST(MapperLost, AfterSecondsThatItMissedOdometrySaysWhereItIsAndNothingIsSought) {
  LostDrive drive;
  drive.with_odometry(2.0);
  (void)drive.steps(40);
  drive.with_odometry(5.0, 20.0);
  drive.turn += 60;  // 3 s, 9 m
  const auto first = drive.step();
  EXPECT_FALSE(first) << "one alone after a gap may be an error";
  const auto update = drive.step();
  ASSERT_TRUE(update);
  EXPECT_TRUE(update->registered);
  EXPECT_EQ(update->fix, tracking::Fix::kTracking);
  EXPECT_LT(drive.error(*update), 0.1);
  EXPECT_EQ(drive.counter("bridged"), 1);
  EXPECT_EQ(drive.counter("lost.blind"), 0);
  EXPECT_EQ(drive.counter("searches"), 0);
}

TEST(MapperLost, OdometrySaysSoThoughTheLastScanBeforeThoseSecondsOutranIt) {
  for (const double until : {1.96, 1.9}) {  // s; the last scan ends at 2.0
    LostDrive drive;
    drive.with_odometry(until);
    (void)drive.steps(40);
    drive.with_odometry(5.0, 20.0);
    drive.turn += 60;
    (void)drive.steps(2);
    EXPECT_EQ(drive.counter("bridged"), 1) << until;
    EXPECT_EQ(drive.counter("lost.blind"), 0) << until;
  }
}

TEST(MapperLost, WhereOdometryBeganAnewInTheSecondsThatItMissedTheVehicleIsSought) {
  for (const double x : {-25.0, -9.0, 4.0, 300.0}) {
    LostDrive drive;
    drive.with_odometry(2.0);
    (void)drive.steps(40);
    drive.with_odometry(4.0, 20.0, test::pose(x, 3, 0, 0, 0, 0.4));
    drive.turn += 40;
    std::optional<MapperUpdate> update;
    for (int i = 0; i < 60; ++i) {
      update = drive.step();
      if (update && update->registered) {
        EXPECT_LT(drive.error(*update), 0.15) << x << " " << i;
      }
    }
    EXPECT_EQ(drive.counter("bridged"), 0) << x;
    EXPECT_EQ(drive.counter("lost.blind"), 1) << x;
    EXPECT_EQ(drive.counter("found"), 1) << x;
  }
}

TEST(MapperLost, AFastVehicleIsSoughtAheadOfWhereItWasSeenLast) {
  LostDrive drive;
  drive.trajectory = [](double t) { return test::pose(-28 + 8 * t, 0, 0, 0, 0, 0); };
  (void)drive.steps(50);
  drive.turn += 30;  // 1.5 s, 12 m
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 40 && drive.counter("found") == 0; ++i) update = drive.step();
  EXPECT_EQ(drive.counter("found"), 1);
  update = drive.steps(5);
  ASSERT_TRUE(update && update->registered);
  EXPECT_LT(drive.error(*update), 0.10);
}

TEST(MapperLost, WhoIsCarriedElsewhereIsNotFoundAndTheMapStays) {
  LostDrive drive;
  (void)drive.steps(40);
  const std::int64_t points = drive.dense().size();
  drive.turn += 40;
  for (int i = 0; i < 60; ++i) {
    const auto update = drive.step_in(yard());
    EXPECT_FALSE(update && update->registered) << i;
  }
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kLost);
  EXPECT_EQ(drive.dense().size(), points);
  EXPECT_EQ(drive.counter("found"), 0);
  EXPECT_GT(drive.counter("searches"), 2);
}

TEST(MapperLost, WhoMayBeAnywhereIsSoughtLessOftenAsThatIsDear) {
  LostDrive drive;
  (void)drive.steps(40);
  drive.turn += 200;  // 10 s in which nothing was seen
  for (int i = 0; i < 60; ++i) (void)drive.step_in(yard());
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kLost);
  EXPECT_EQ(drive.counter("searches"), 2) << "within 3 s";
}

TEST(MapperLost, OdometryLeadsItBackToTheMap) {
  LostDrive drive;
  drive.with_odometry(20);
  (void)drive.steps(40);
  for (int i = 0; i < 60; ++i) (void)drive.step_in(yard());  // a lorry all around, for 3 s
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kLost);
  std::optional<MapperUpdate> update = drive.steps(5);
  ASSERT_TRUE(update);
  EXPECT_LT(drive.error(*update), 0.1) << "odometry leads it back to the map";
  (void)drive.steps(10);
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kTracking);
  EXPECT_EQ(drive.counter("began_anew"), 0);
}

TEST(MapperLost, WhereNextToNothingIsSeenOdometryLeadsOnAndSaysHowFarOffItMayBe) {
  LostDrive drive;
  drive.with_odometry(20);
  (void)drive.steps(40);
  const std::int64_t points = drive.dense().size();
  double doubt = 0;
  for (std::size_t i = 0; i < 60; ++i) {  // fog for 3 s, 9 m
    scan::Scan fog = drive.next();
    fog.points.resize(i % 3 * 150);
    const auto update = drive.step(fog);
    ASSERT_TRUE(update && !update->registered) << i;
    EXPECT_LT(drive.error(*update), 0.05) << i;
    EXPECT_EQ(update->fix, tracking::Fix::kTracking) << "nothing contradicts odometry";
    const double sigma = std::sqrt(update->registration.covariance(0, 0));
    EXPECT_GT(sigma, doubt) << i;
    doubt = sigma;
  }
  EXPECT_GT(doubt, 0.3);
  EXPECT_LT(doubt, 0.8);
  EXPECT_EQ(drive.dense().size(), points);
  const auto update = drive.step();
  ASSERT_TRUE(update && update->registered);
  EXPECT_LT(drive.error(*update), 0.05);
  EXPECT_EQ(drive.counter("searches"), 0);
}

TEST(MapperLost, AfterALongWayWithNothingInSightItIsLostAndTheMapGoesOnWhereOdometryHasLed) {
  LostDrive drive;
  drive.with_odometry(20);
  (void)drive.steps(40);
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 140; ++i) {  // 21 m
    scan::Scan fog = drive.next();
    fog.points.clear();
    update = drive.step(fog);
    ASSERT_TRUE(update && !update->registered) << i;
    EXPECT_LT(drive.error(*update), 0.1) << i;
  }
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kLost);
  EXPECT_EQ(drive.counter("lost.refused"), 1);
  EXPECT_EQ(drive.counter("began_anew"), 0) << "nothing to begin with";
  update = drive.steps(20);
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kTracking);
  EXPECT_LT(drive.error(*update), 0.1);
}

TEST(MapperLost, WithoutOdometryAScanThatShowsNothingTellsNothing) {
  LostDrive drive;
  (void)drive.steps(40);
  scan::Scan fog = drive.next();
  fog.points.clear();
  EXPECT_FALSE(drive.step(fog));
  std::vector<std::string> faults;
  drive.mapper->add_faults(faults);
  EXPECT_TRUE(faults.empty());
  for (int i = 0; i < 10; ++i) {
    fog = drive.next();
    fog.points.clear();
    (void)drive.step(fog);
  }
  drive.mapper->add_faults(faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_NE(faults[0].find("fewer than 400 returns in each of the last 11 revolutions"), std::string::npos)
      << faults[0];
}

TEST(MapperLost, WhereOdometryHasLedOnToNewGroundTheMapBeginsAnewThere) {
  LostDrive drive;
  drive.with_odometry(20);
  (void)drive.steps(40);
  const std::int64_t points = drive.dense().size();
  drive.world = test::SyntheticWorld{};  // out of a long tunnel: nothing of the street is seen any more
  drive.world.noise = 0.01;
  drive.world.boxes = {{{-30, -6, 0}, {-12, -5, 3}}, {{-5, 5, 0}, {6, 6, 3}},   {{12, -7, 0}, {15, -4, 5}},
                       {{20, 6, 0}, {24, 9, 2}},     {{30, -3, 0}, {31, 3, 4}}, {{-20, 9, 0}, {-10, 12, 6}}};
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 110; ++i) update = drive.step();
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kLost) << "it is sought first";
  EXPECT_EQ(drive.dense().size(), points);
  update = drive.steps(60);
  ASSERT_TRUE(update && update->registered);
  EXPECT_EQ(drive.counter("began_anew"), 1);
  EXPECT_LT(drive.error(*update), 0.1) << "odometry led here";
  const pose_graph::Atlas& atlas = drive.mapper->atlas();
  EXPECT_FALSE(atlas.present(0)) << "what lies before is not what is seen now";
  EXPECT_EQ(atlas.connected(0, 1e9).size(), static_cast<std::size_t>(atlas.size())) << "but the drive is one";
  EXPECT_GT(drive.dense().size(), points);
}

TEST(MapperLost, WhatWasMappedWhereTheVehicleWasNotIsTakenBack) {
  LostDrive drive;
  drive.with_odometry(20);
  (void)drive.steps(40);
  // For 2 s the scans show a vehicle that stands, with a lorry beside it; odometry and truth drive on.
  test::SyntheticWorld frozen = street_with_a_kiosk();
  frozen.boxes.push_back({{-1, 2.5, 0}, {5, 3.5, 3}});
  const Pose stands = drive.trajectory(40 * test::kPeriod);
  for (int i = 0; i < 40; ++i) {
    const int n = drive.turn++;
    (void)drive.step(test::scan_of(frozen.packets([&](double) { return stands; }, drive.config.vehicle.T_base_lidar(),
                                                  n, n * test::kPeriod, test::kPeriod)));
  }
  std::optional<MapperUpdate> update;
  bool rearranged = false;
  for (int i = 0; i < 60; ++i) {
    update = drive.step();
    rearranged = rearranged || (update && update->rearranged);
  }
  EXPECT_TRUE(rearranged);
  EXPECT_EQ(drive.counter("rolled_back"), 1);
  ASSERT_TRUE(update && update->registered);
  EXPECT_LT(drive.error(*update), 0.08);
  const Pose T_map_world = drive.T_world_map.inverse();
  for (const TileKey& key : drive.dense().keys()) {
    const dense_map::DenseTile& tile = *drive.dense().tile(key);
    for (const TilePoint& p : tile.read()->points()) {
      const Eigen::Vector3d in_map(key.x * kTileSize + p.x * kPositionStep, key.y * kTileSize + p.y * kPositionStep,
                                   tile.z_origin() + p.z * kPositionStep);
      const Eigen::Vector3d q = T_map_world.inverse() * in_map;
      const bool in_lorry = q.x() > -0.9 && q.x() < 4.9 && std::abs(q.y() - 2.5) < 0.2 && q.z() > 1.6;
      ASSERT_FALSE(in_lorry) << q.transpose();
    }
  }
}

TEST(MapperLost, ASavedMapIsGoneOnWithFromAboutTheStart) {
  LostDrive first;
  first.with_odometry(20);
  (void)first.steps(60);
  first.mapper->wait();
  const storage::SavedMap map = first.mapper->saved(7);
  EXPECT_EQ(map.epoch, 7);
  EXPECT_EQ(map.nodes.size(), static_cast<std::size_t>(first.mapper->atlas().size()));

  for (const config::MapMode mode : {config::MapMode::kExtend, config::MapMode::kLocalise}) {
    LostDrive second;
    second.with_odometry(20);
    second.turn = 20;
    const Pose start = first.T_world_map.inverse() * second.trajectory(20 * test::kPeriod);
    second.config.mode = mode;
    second.config.start_x = start.translation().x() + 1.0;  // known to a metre or two
    second.config.start_y = start.translation().y() - 1.0;
    second.config.start_yaw = roll_pitch_yaw(start.linear()).z() + 0.1;
    second.config.start_radius = 2.0;
    second.mapper.emplace(second.config);
    second.mapper->load(map);
    const std::int64_t points = second.dense().size();
    EXPECT_EQ(points, first.dense().size());
    std::optional<MapperUpdate> update;
    for (int i = 0; i < 60; ++i) update = second.step();
    SCOPED_TRACE(mode == config::MapMode::kExtend ? "extend" : "localise");
    ASSERT_TRUE(update && update->registered);
    EXPECT_EQ(second.counter("found"), 1);
    const Pose truth = first.T_world_map.inverse() * second.truth(update->utime);
    EXPECT_LT((truth.inverse() * update->T_map_base).translation().norm(), 0.05);
    if (mode == config::MapMode::kLocalise) {
      EXPECT_EQ(second.dense().size(), points) << "only uses the map";
      EXPECT_EQ(second.mapper->atlas().size(), first.mapper->atlas().size());
    } else {
      EXPECT_GT(second.dense().size(), points);
      EXPECT_GT(second.mapper->atlas().size(), first.mapper->atlas().size());
    }
  }
}

}  // namespace
}  // namespace curbstone::mapper
