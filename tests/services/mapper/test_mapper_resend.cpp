#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/resend/message_keeper.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

constexpr int kRevolutions = 80;  // 4 s

/// Packets and odometry of a drive in the order in which they are sent.
struct Sensors {
  std::vector<lidar_points_t> packets;
  std::vector<odometry_t> odometry;

  static const Sensors& of_a_drive() {
    static const Sensors sensors = [] {
      Sensors all;
      test::SyntheticWorld world = test::street();
      world.noise = 0.01;
      const Pose T_base_lidar = config::MapperConfig{}.vehicle.T_base_lidar();
      for (int i = 0; i < kRevolutions; ++i) {
        for (auto& packet : world.packets(test::driving, T_base_lidar, i, i * test::kPeriod, test::kPeriod))
          all.packets.push_back(std::move(packet));
      }
      for (double t = -0.1; t < kRevolutions * test::kPeriod + 0.1; t += 0.01) {
        odometry_t m{};
        m.utime = test::utime(t);
        m.flags = odometry_t::INITIALISED;
        pose_to_arrays(test::driving(0).inverse() * test::driving(t), m.position, m.orientation);
        all.odometry.push_back(m);
      }
      return all;
    }();
    return sensors;
  }
};

/// What a mapper on a bus says of a drive. From `deaf_from` to `deaf_to`, s, it hears nothing, as a process that is
/// stopped and whose socket is full; and it loses each `loses`th message.
struct ResentDrive {
  std::vector<std::array<double, 4>> poses;  // utime, position
  std::map<std::string, std::vector<std::array<int, 4>>> tiles;
  Counters counters;

  ResentDrive(double deaf_from, double deaf_to, int loses = 0) {
    LocalBus bus, lossy;
    MessageKeeper driver(bus, "LIDAR_POINTS"), filter(bus, "ODOMETRY");
    MapperNode node(config::MapperConfig{}, lossy);
    node.connect(lossy);
    lossy.subscribe<resend_request_t>(kResendRequests, [&](const resend_request_t& m) {
      driver.request(m);
      filter.request(m);
    });
    int count = 0;
    const auto pass = [&](const std::string& channel, const auto& message) {
      if (loses == 0 || ++count % loses != 0) lossy.publish(channel, message);
    };
    bus.subscribe<lidar_points_t>(resent_channel("LIDAR_POINTS"),
                                  [&](const lidar_points_t& m) { pass(resent_channel("LIDAR_POINTS"), m); });
    bus.subscribe<odometry_t>(resent_channel("ODOMETRY"),
                              [&](const odometry_t& m) { pass(resent_channel("ODOMETRY"), m); });
    lossy.subscribe<map_pose_t>("MAP_POSE", [&](const map_pose_t& m) {
      poses.push_back(
          {static_cast<double>(m.utime), m.map_base_position[0], m.map_base_position[1], m.map_base_position[2]});
    });
    lossy.subscribe<map_points_t>("MAP_POINTS", [&](const map_points_t& m) { take(m); });
    const auto is_deaf = [&](std::int64_t utime) {
      return utime >= test::utime(deaf_from) && utime < test::utime(deaf_to);
    };
    const Sensors& sensors = Sensors::of_a_drive();
    auto odometry = sensors.odometry.begin();
    std::int64_t ticked = 0;
    for (const lidar_points_t& packet : sensors.packets) {
      for (; odometry->utime <= packet.utime; ++odometry) {
        filter.keep(*odometry);
        if (!is_deaf(packet.utime)) pass("ODOMETRY", *odometry);
      }
      driver.keep(packet);
      if (!is_deaf(packet.utime)) pass("LIDAR_POINTS", packet);
      lossy.dispatch();
      if (packet.utime - ticked < 20'000) continue;
      ticked = packet.utime;
      driver.tick();
      filter.tick();
      bus.dispatch();
      if (!is_deaf(packet.utime)) node.tick(packet.utime);
      lossy.dispatch();
    }
    for (; odometry != sensors.odometry.end(); ++odometry) lossy.publish("ODOMETRY", *odometry);
    lossy.dispatch();
    for (int i = 0; i < 20; ++i, ticked += 20'000) {
      driver.tick();
      filter.tick();
      bus.dispatch();
      node.tick(ticked);
      lossy.dispatch();
    }
    node.finish();
    lossy.dispatch();
    counters = node.report().counters;
  }

  void take(const map_points_t& m) {
    auto& points = tiles[std::to_string(m.tile_x) + "," + std::to_string(m.tile_y)];
    for (int i = 0; i < m.num_points; ++i) {
      const auto k = static_cast<std::size_t>(i);
      points.resize(std::max(points.size(), static_cast<std::size_t>(m.first + i) + 1));
      points[static_cast<std::size_t>(m.first + i)] = {m.x[k], m.y[k], m.z[k], m.intensity[k]};
    }
  }
};

TEST(MapperResend, ManyRevolutionsThatBecomeDueAtOnceAreWorkedOnInTurns) {
  const ResentDrive whole(0, 0);
  const Sensors& sensors = Sensors::of_a_drive();
  LocalBus bus;
  MapperNode node(config::MapperConfig{}, bus);
  std::vector<std::array<double, 4>> poses;
  bus.subscribe<map_pose_t>("MAP_POSE", [&](const map_pose_t& m) {
    poses.push_back(
        {static_cast<double>(m.utime), m.map_base_position[0], m.map_base_position[1], m.map_base_position[2]});
  });
  for (const odometry_t& m : sensors.odometry) node.on(m);
  constexpr std::size_t kLost = 500;
  for (std::size_t i = 0; i < sensors.packets.size(); ++i) {
    if (i != kLost) node.on(sensors.packets[i]);
  }
  bus.dispatch();
  const std::size_t before = poses.size();
  EXPECT_LT(before, 20U) << "what lies behind the gap waits";
  node.on_resent(sensors.packets[kLost]);
  bus.dispatch();
  EXPECT_LT(poses.size(), static_cast<std::size_t>(kRevolutions) - 1) << "a status is due each second";
  for (int i = 0; i < kRevolutions; ++i) node.tick(test::utime(kRevolutions * test::kPeriod));
  node.finish();
  bus.dispatch();
  EXPECT_TRUE(poses == whole.poses) << "in order, at the same places";
}

TEST(MapperResend, AMapperThatHeardNothingForSecondsMakesTheSameMap) {
  const ResentDrive whole(0, 0), stopped(1.0, 2.2);
  ASSERT_EQ(whole.poses.size(), static_cast<std::size_t>(kRevolutions));
  EXPECT_TRUE(stopped.poses == whole.poses) << "in order, at the same places";
  EXPECT_TRUE(stopped.tiles == whole.tiles);
  EXPECT_EQ(stopped.counters["lidar.lost"], 0);
  EXPECT_GT(stopped.counters["lidar.resent"], 500);
  EXPECT_GT(stopped.counters["odometry.resent"], 100);
}

TEST(MapperResend, ABusThatLosesMessagesMakesTheSameMap) {
  const ResentDrive whole(0, 0), lossy(0, 0, 23);
  EXPECT_EQ(lossy.counters["lidar.lost"], 0);
  EXPECT_EQ(lossy.counters["odometry.not_resent"], 0);
  EXPECT_EQ(lossy.counters["odometry.too_late"], 0);
  EXPECT_GT(lossy.counters["odometry.resent"], 5);
  ASSERT_EQ(lossy.poses.size(), whole.poses.size());
  for (std::size_t i = 0; i < whole.poses.size(); ++i) ASSERT_EQ(lossy.poses[i], whole.poses[i]) << i;
  EXPECT_TRUE(lossy.tiles == whole.tiles);
}

}  // namespace
}  // namespace curbstone::mapper
