#include "services/mapper/pose_graph/loop_closer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

constexpr double kRadius = 60;      // m, of a ring road
constexpr double kNodeSpacing = 2;  // m
constexpr double kWindow = 50;      // m, of the map for registration

/// Houses on both sides of the ring road, no two alike.
test::SyntheticWorld ring_road(int seed) {
  test::SyntheticWorld world;
  world.noise = 0.01;
  const auto some = [&](double i, double from, double to) {
    const double x = std::sin((i + 1) * 12.9898 + seed * 78.233) * 43758.5453;
    return from + (to - from) * (x - std::floor(x));
  };
  int n = 0;
  for (double a = 0; a < 2 * std::numbers::pi; a += some(n++, 0.12, 0.3)) {
    for (const double r : {kRadius + some(n + 0.1, 9, 14), kRadius - some(n + 0.2, 9, 14)}) {
      const Eigen::Vector3d middle(r * std::cos(a + some(n, 0, 0.1)), r * std::sin(a), 0);
      const Eigen::Vector3d half(some(n + 0.3, 1, 4), some(n + 0.4, 1, 4), 0);
      world.boxes.push_back({middle - half, middle + half + Eigen::Vector3d(0, 0, some(n + 0.5, 1.5, 6))});
    }
  }
  return world;
}

Pose on_the_road(double metres) {
  const double a = metres / kRadius;
  return test::pose(kRadius * std::cos(a), kRadius * std::sin(a), 0, 0, 0, a + std::numbers::pi / 2);
}

/// A drive round the ring with the drift of a bad day: 1 % of the way and 3 degrees a round.
struct RingDrive {
  test::SyntheticWorld world = ring_road(1);
  Atlas atlas;
  Relocalizer finder{config::IcpConfig{}, test::default_lidar().translation()};
  LoopCloser closer{config::LoopConfig{}};
  double driven = 0;
  Pose T_map_base = on_the_road(0);

  RingDrive() : atlas(config()) {}
  static config::AtlasConfig config() {
    config::AtlasConfig config;
    config.spacing = kNodeSpacing;
    return config;
  }
  std::vector<scan::LidarPoint> scan() const { return world.snapshot(on_the_road(driven), test::default_lidar()); }
  void go(double metres) {
    const Pose step = on_the_road(driven).inverse() * on_the_road(driven + metres);
    const Pose drift(Eigen::Translation3d(0.01 * metres, 0, 0) *
                     Eigen::AngleAxisd(0.05 * metres / (2 * std::numbers::pi * kRadius), Eigen::Vector3d::UnitZ()));
    driven += metres;
    T_map_base = T_map_base * step * drift;
  }
  void map() {
    atlas.visit(static_cast<std::int64_t>(driven * 1e6), T_map_base, scan());
    atlas.forget_far(T_map_base.translation(), kWindow);
  }
  [[nodiscard]] double error() const { return (T_map_base.translation() - on_the_road(driven).translation()).norm(); }
};

class OnceRound : public testing::Test {
 protected:
  OnceRound() {
    for (drive_.map(); drive_.driven < 2 * std::numbers::pi * kRadius - 5; drive_.map()) drive_.go(kNodeSpacing + 0.05);
  }
  std::optional<LoopClosure> look_while_driving(double metres) {
    for (double s = 0; s < metres; s += 0.7) {
      drive_.go(0.7);
      drive_.map();
      if (auto closure = drive_.closer.search(drive_.atlas, drive_.finder, drive_.scan(), drive_.T_map_base))
        return closure;
    }
    return std::nullopt;
  }
  RingDrive drive_;
};

TEST_F(OnceRound, TheLoopIsClosedAndTheDrivePutRight) {
  ASSERT_GT(drive_.error(), 2.5);
  const auto closure = look_while_driving(20);
  ASSERT_TRUE(closure);
  const Pose truth = on_the_road(drive_.driven);
  const Pose seen = drive_.atlas.node(closure->node).T_map_base * closure->T_node_base;
  EXPECT_LT(drive_.atlas.node(closure->node).T_map_base.translation().x(), kRadius + 1);
  EXPECT_NEAR((seen.translation() - truth.translation()).norm(), 0, 0.25) << "the old node has its own small drift";

  const std::vector<Pose> before = drive_.atlas.poses();
  const auto correction = drive_.closer.solve(drive_.atlas, *closure, drive_.T_map_base);
  ASSERT_TRUE(correction);
  EXPECT_TRUE(drive_.closer.is_significant(*correction, drive_.atlas));
  EXPECT_TRUE(drive_.atlas.poses().front().isApprox(before.front())) << "moves nothing itself";
  const Pose& last = correction->T_new_old[static_cast<std::size_t>(drive_.atlas.reference())];
  EXPECT_LT((last * drive_.T_map_base.translation() - truth.translation()).norm(), 0.3);
  EXPECT_TRUE(correction->T_new_old.front().isApprox(Pose::Identity())) << "the beginning stays where it is";
  drive_.closer.note_solved(correction);
  EXPECT_EQ(drive_.closer.counters()["loops.closed"], 1);
  EXPECT_FALSE(drive_.atlas.edges().back().closes_loop) << "adds nothing itself";
  EXPECT_TRUE(correction->loop.closes_loop);
}

TEST_F(OnceRound, ElsewhereNoLoopIsClosed) {
  drive_.world = ring_road(7);  // the same road, other houses
  EXPECT_FALSE(look_while_driving(20));
  EXPECT_GT(drive_.closer.counters()["loops.looked"], 3);
  EXPECT_EQ(drive_.closer.counters()["loops.seen"], 0);
}

TEST_F(OnceRound, AClosureThatContradictsTheDriveIsRefused) {
  const std::size_t edges = drive_.atlas.edges().size();
  LoopClosure wrong;
  wrong.node = 10;
  wrong.T_node_base = test::pose(40, 30, 0, 0, 0, 2);
  wrong.covariance = 1e-4 * registration::Matrix6::Identity();
  const auto correction = drive_.closer.solve(drive_.atlas, wrong, drive_.T_map_base);
  EXPECT_FALSE(correction);
  drive_.closer.note_solved(correction);
  EXPECT_EQ(drive_.atlas.edges().size(), edges);
  EXPECT_EQ(drive_.closer.counters()["loops.refused"], 1);
}

TEST_F(OnceRound, ALoopIsUncertainAlongTheAxesOfTheNodeThatItEndsAt) {
  const auto closure = look_while_driving(20);
  ASSERT_TRUE(closure);
  LoopClosure seen = *closure;
  seen.covariance = registration::Vector6(0.25, 1e-6, 1e-6, 1e-9, 1e-9, 1e-9).asDiagonal();  // unknown ahead of itself
  // The vehicle has turned by a right angle since the last node, towards -y of that node.
  const Pose& T_map_reference = drive_.atlas.node(drive_.atlas.reference()).T_map_base;
  const Pose T_reference_base = test::pose(1, 0, 0, 0, 0, -std::numbers::pi / 2);
  seen.T_node_base = seen.T_node_base * drive_.T_map_base.inverse() * T_map_reference * T_reference_base;
  const auto correction = drive_.closer.solve(drive_.atlas, seen, T_map_reference * T_reference_base);
  ASSERT_TRUE(correction);
  EXPECT_LT(correction->loop.information(1, 1), 1 / 0.25);
  EXPECT_GT(correction->loop.information(0, 0), 1000) << "to 20 mm along the node's own x axis";
}

TEST_F(OnceRound, IsNotClosedWhereThatIsNotWanted) {
  config::LoopConfig config;
  config.close = false;
  drive_.closer = LoopCloser(config);
  EXPECT_FALSE(look_while_driving(20));
  EXPECT_EQ(drive_.closer.counters()["loops.looked"], 0);
}

}  // namespace
}  // namespace curbstone::mapper::pose_graph
