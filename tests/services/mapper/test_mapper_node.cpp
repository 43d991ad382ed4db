#include "services/mapper/mapper_node.hpp"

#include <gtest/gtest.h>

#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <map>
#include <random>

#include "common/bus/local_bus.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::driving;
using test::kPeriod;
using test::utime;

constexpr int kTurns = 25;

odometry_t odometry_at(double t, std::int32_t flags = odometry_t::INITIALISED) {
  odometry_t m{};
  m.utime = utime(t);
  m.flags = flags;
  pose_to_arrays(driving(0).inverse() * driving(t), m.position, m.orientation);
  return m;
}

const std::vector<lidar_points_t>& lidar() {
  static const std::vector<lidar_points_t> packets = [] {
    test::SyntheticWorld world = test::street();
    world.noise = 0.01;
    std::vector<lidar_points_t> out;
    for (int i = 0; i < kTurns; ++i) {
      for (auto& packet : world.packets(driving, test::default_lidar(), i, i * kPeriod, kPeriod))
        out.push_back(std::move(packet));
    }
    return out;
  }();
  return packets;
}

/// What a subscriber puts together from MAP_POINTS: whatever comes twice must be the same.
struct Follower {
  std::map<TileKey, std::vector<std::array<int, 4>>> tiles;
  std::map<TileKey, std::int32_t> announced;
  std::vector<map_pose_t> poses;
  int messages = 0;
  int largest = 0;
  std::int32_t epoch = 0;
  bool contradiction = false;
  bool gap = false;

  explicit Follower(LocalBus& bus) {
    bus.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) { on(m); });
    bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { poses.push_back(m); });
    bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) {
      EXPECT_EQ(m.owner, "mapper");
      if (m.channel == "MAP_TRAJECTORY") return;
      EXPECT_EQ(m.channel, "MAP_POINTS");
      for (std::size_t i = 0; i < m.tile_x.size(); ++i) announced[{m.tile_x[i], m.tile_y[i]}] = m.version[i];
    });
  }
  void on(const map_points_t& m) {
    ++messages;
    largest = std::max(largest, m.getEncodedSize());
    epoch = m.epoch;
    auto& points = tiles[{m.tile_x, m.tile_y}];
    gap |= m.first > static_cast<std::int32_t>(points.size());
    for (int i = 0; i < m.num_points; ++i) {
      const auto at = static_cast<std::size_t>(m.first + i);
      const auto k = static_cast<std::size_t>(i);
      const std::array<int, 4> p{m.x[k], m.y[k], m.z[k], m.intensity[k]};
      if (at < points.size())
        contradiction |= points[at] != p;
      else
        points.push_back(p);
    }
  }
};

struct Bench {
  LocalBus bus;
  MapperNode node{config::MapperConfig{}, bus};
  Follower follower{bus};
  Bench() { node.connect(bus); }
  void finish() {
    node.finish();
    bus.dispatch();
  }
};

/// The drive with odometry coming `lag` s late, ticks every 20 ms.
void drive(Bench& bench, double lag, bool with_odometry = true) {
  double next_odometry = -0.1;
  std::int64_t next_tick = 0;
  for (const lidar_points_t& packet : lidar()) {
    for (; with_odometry && utime(next_odometry + lag) <= packet.utime; next_odometry += 0.01) {
      bench.bus.publish("ODOMETRY", odometry_at(next_odometry));
    }
    bench.bus.publish("LIDAR_POINTS", packet);
    bench.bus.dispatch();
    if (packet.utime >= next_tick) {
      bench.node.tick(packet.utime);
      bench.bus.dispatch();
      next_tick = packet.utime + 20'000;
    }
  }
  for (; with_odometry && next_odometry < kTurns * kPeriod + 0.1; next_odometry += 0.01) {
    bench.bus.publish("ODOMETRY", odometry_at(next_odometry));
  }
  bench.bus.dispatch();
  bench.finish();
}

TEST(MapperNode, MapsADriveAndTellsWhereItWas) {
  Bench bench;
  drive(bench, 0.01);
  ASSERT_EQ(bench.follower.poses.size(), static_cast<std::size_t>(kTurns));
  for (const map_pose_t& pose : bench.follower.poses) EXPECT_EQ(pose.flags, map_pose_t::REGISTERED) << pose.revolution;
  const map_pose_t& last = bench.follower.poses.back();
  const Pose T_map_base = pose_from_arrays(last.map_base_position, last.map_base_orientation);
  const Pose T_map_odom = pose_from_arrays(last.map_odom_position, last.map_odom_orientation);
  const double end = static_cast<double>(last.utime - test::SyntheticWorld::kEpoch) * 1e-6;
  const double begin = static_cast<double>(bench.follower.poses.front().utime - test::SyntheticWorld::kEpoch) * 1e-6;
  EXPECT_LT((T_map_base.translation() - (driving(begin).inverse() * driving(end)).translation()).norm(), 0.02);
  EXPECT_TRUE((T_map_odom * driving(0).inverse() * driving(end)).isApprox(T_map_base, 1e-6));
  EXPECT_GT(last.covariance[0], 0);
  EXPECT_EQ(last.epoch, 1'700'000'000);
  EXPECT_TRUE(bench.node.report().faults.empty());
}

TEST(MapperNode, SendsWhatTheMapHoldsInSmallMessages) {
  Bench bench;
  drive(bench, 0.01);
  EXPECT_LE(bench.follower.largest, 48'000);
  EXPECT_GT(bench.follower.messages, 100);
  EXPECT_FALSE(bench.follower.contradiction);
  EXPECT_FALSE(bench.follower.gap);
  std::int64_t total = 0;
  for (const auto& [key, points] : bench.follower.tiles) {
    const dense_map::DenseTile* tile = bench.node.mapper().dense().tile(key);
    ASSERT_NE(tile, nullptr);
    EXPECT_EQ(points.size(), tile->num_points());
    EXPECT_EQ(bench.follower.announced[key], static_cast<std::int32_t>(points.size()));
    total += static_cast<std::int64_t>(points.size());
  }
  EXPECT_EQ(total, bench.node.mapper().dense().size());
}

TEST(MapperNode, TheMapDoesNotDependOnHowTheChannelsInterleave) {
  Bench prompt, late, before;
  drive(prompt, 0.0);
  drive(late, 0.15);
  // ...nor on odometry that is far ahead, nor on there being no ticks at all
  for (double t = -0.1; t < kTurns * kPeriod + 0.1; t += 0.01) before.bus.publish("ODOMETRY", odometry_at(t));
  for (const lidar_points_t& packet : lidar()) before.bus.publish("LIDAR_POINTS", packet);
  before.bus.dispatch();
  before.finish();
  ASSERT_GT(prompt.follower.tiles.size(), 50u);
  for (Bench* other : {&late, &before}) {
    EXPECT_EQ(prompt.follower.tiles, other->follower.tiles);
    ASSERT_EQ(prompt.follower.poses.size(), other->follower.poses.size());
    for (std::size_t i = 0; i < prompt.follower.poses.size(); ++i) {
      std::vector<std::uint8_t> a(1000), b(1000);
      EXPECT_EQ(prompt.follower.poses[i].encode(a.data(), 0, 1000), other->follower.poses[i].encode(b.data(), 0, 1000));
      EXPECT_EQ(a, b) << i;
    }
  }
}

TEST(MapperNode, GoesOnWithoutOdometryAndSaysSo) {
  Bench bench;
  drive(bench, 0, false);
  ASSERT_GE(bench.follower.poses.size(), static_cast<std::size_t>(kTurns - 1));
  for (const map_pose_t& pose : bench.follower.poses) EXPECT_TRUE(pose.flags & map_pose_t::NO_ODOMETRY);
  EXPECT_GT(bench.follower.tiles.size(), 50u);
  ASSERT_EQ(bench.node.report().faults.size(), 1u);
  EXPECT_NE(bench.node.report().faults[0].find("ODOMETRY"), std::string::npos);
}

TEST(MapperNode, WaitsForOdometryToKnowItsAttitudeBeforeItBegins) {
  Bench bench;
  for (double t = -0.1; t < 0.6; t += 0.01) bench.bus.publish("ODOMETRY", odometry_at(t, 0));
  for (double t = 0.6; t < 2; t += 0.01) bench.bus.publish("ODOMETRY", odometry_at(t));
  for (const lidar_points_t& packet : lidar()) bench.bus.publish("LIDAR_POINTS", packet);
  bench.bus.dispatch();
  bench.finish();
  ASSERT_FALSE(bench.follower.poses.empty());
  EXPECT_GE(bench.follower.poses.front().utime, utime(0.6));
  EXPECT_FALSE(bench.follower.poses.front().flags & map_pose_t::NO_ODOMETRY);
}

TEST(MapperNode, AnswersARequestWithExactlyTheMissingPoints) {
  Bench bench;
  drive(bench, 0.01);
  const auto largest = std::max_element(bench.follower.tiles.begin(), bench.follower.tiles.end(),
                                        [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  const TileKey key = largest->first;
  const auto total = static_cast<std::int32_t>(largest->second.size());
  ASSERT_GT(total, 500);
  std::vector<map_points_t> answers;
  bench.bus.subscribe<map_points_t>("MAP_POINTS", [&](const map_points_t& m) { answers.push_back(m); });
  tile_request_t request{};
  request.channel = "MAP_POINTS";
  request.epoch = bench.follower.epoch;
  request.num_tiles = 3;
  request.tile_x = {key.x, 5000, key.x};
  request.tile_y = {key.y, 5000, key.y};
  request.have = {total - 123, 0, total - 123};
  bench.bus.publish("TILE_REQUEST", request);
  bench.bus.dispatch();
  for (int i = 0; i < 20; ++i) bench.node.tick(utime(10 + 0.02 * i));
  bench.bus.dispatch();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].tile_x, key.x);
  EXPECT_EQ(answers[0].tile_y, key.y);
  EXPECT_EQ(answers[0].first, total - 123);
  EXPECT_EQ(answers[0].num_points, 123);
  answers.clear();
  request.epoch += 1;
  bench.bus.publish("TILE_REQUEST", request);
  bench.bus.dispatch();
  for (int i = 0; i < 20; ++i) bench.node.tick(utime(11 + 0.02 * i));
  bench.bus.dispatch();
  EXPECT_TRUE(answers.empty());
}

TEST(MapperNode, SurvivesGarbageOnEveryChannel) {
  Bench bench;
  std::mt19937 random(7);
  const auto& good = lidar();
  for (int i = 0; i < 3000; ++i) {
    lidar_points_t m = good[static_cast<std::size_t>(i) % good.size()];
    switch (random() % 6) {
      case 0:
        m.utime = static_cast<std::int64_t>((static_cast<std::uint64_t>(random()) << 32) | random());
        break;
      case 1:
        m.packet = static_cast<std::int32_t>(random());
        break;
      case 2:
        m.revolution = static_cast<std::int32_t>(random());
        break;
      case 3:
        for (float& x : m.x) x = std::numeric_limits<float>::quiet_NaN();
        break;
      case 4:
        for (float& x : m.x) x *= 1e20F;
        break;
      default:
        break;
    }
    bench.bus.publish("LIDAR_POINTS", m);
    odometry_t o = odometry_at(0.01 * i);
    if (random() % 3 == 0) o.orientation[random() % 4] = 1e300;
    if (random() % 3 == 0) o.position[random() % 3] = std::numeric_limits<double>::infinity();
    if (random() % 3 == 0) o.utime = static_cast<std::int64_t>((static_cast<std::uint64_t>(random()) << 32) | random());
    bench.bus.publish("ODOMETRY", o);
    std::vector<std::uint8_t> noise(random() % 300);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
    bench.bus.inject("TILE_REQUEST", noise.data(), static_cast<int>(noise.size()));
    bench.bus.dispatch();
    bench.node.tick(static_cast<std::int64_t>(random()) * 1000);
  }
  bench.finish();
  EXPECT_GT(bench.node.report().counters["refused.odometry"], 100);
  for (const map_pose_t& pose : bench.follower.poses) {
    EXPECT_TRUE(is_finite(pose_from_arrays(pose.map_base_position, pose.map_base_orientation)));
  }
}

}  // namespace
}  // namespace curbstone::mapper
