#include <gtest/gtest.h>

#include <curbstone/map_pose_t.hpp>
#include <limits>
#include <random>

#include "tests/services/ekf/ekf_node_test.hpp"

namespace curbstone::ekf {
namespace {

map_pose_t map_pose(const TruePose& truth) {
  map_pose_t m{};
  m.utime = truth.utime;
  m.epoch = 7;
  m.flags = map_pose_t::REGISTERED;
  pose_to_arrays(truth.T_world_base, m.map_base_position, m.map_base_orientation);
  for (int i = 0; i < 6; ++i) m.covariance[7 * i] = 1e-5F;
  return m;
}

TEST_F(EkfNodeTest, MapPosesAreTakenOnlyIfWantedAndWorkTheSameHoweverSoonTheyCome) {
  const auto run = [&](bool fuse, std::size_t samples_late) {
    config_.fuse_map = fuse;
    Rig rig(config_);
    for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
      send(rig, i);
      if (i % 5 == 0 && i >= 200 + samples_late) rig.send("MAP_POSE", map_pose(drive_.truth[i - samples_late]));
    }
    rig.finish();
    EXPECT_EQ(rig.node.report().counters["map.used"] > 20, fuse);
    EXPECT_EQ(rig.node.report().counters["dropped.late.map"], 0);
    return rig.bytes;
  };
  const std::string alone = run(false, 0);
  const std::string at_once = run(true, 0);
  EXPECT_TRUE(at_once == run(true, 20));  // 0.2 s late, as a mapper that works hard
  EXPECT_FALSE(at_once == alone);
}

TEST_F(EkfNodeTest, MapPosesThatJumpOrAreNoneDoNotMoveOdom) {
  config_.fuse_map = true;
  Rig rig(config_);
  std::mt19937 random(4);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    send(rig, i);
    if (i % 5 != 0 || i < 200) continue;
    map_pose_t m = map_pose(drive_.truth[i]);
    switch (random() % 6) {
      case 0:
        m.map_base_position[0] += 30.0;
        break;
      case 1:
        m.map_base_orientation[0] = std::numeric_limits<double>::quiet_NaN();
        break;
      case 2:
        m.covariance[0] = -std::numeric_limits<float>::infinity();
        break;
      case 3:
        m.flags = 0;
        break;
      case 4:
        m.utime += static_cast<std::int64_t>(random()) * 1000;
        break;
      default:
        break;
    }
    rig.send("MAP_POSE", m);
  }
  rig.finish();
  for (std::size_t i = 1; i < rig.odometry.size(); ++i) {
    const Eigen::Vector3d step =
        Eigen::Vector3d(rig.odometry[i].position) - Eigen::Vector3d(rig.odometry[i - 1].position);
    ASSERT_LT(step.norm(), 0.05);
  }
  EXPECT_NEAR(rig.odometry.back().velocity[0], drive_.truth.back().velocity.x(), 0.1);
}

TEST_F(EkfNodeTest, MapPosesThatTheMapperDoesNotTrustAreNotTakenAndCounted) {
  config_.fuse_map = true;
  Rig alone(base::EkfConfig{});
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    send(alone, i);
    send(rig, i);
    if (i % 5 != 0 || i < 200) continue;
    map_pose_t m = map_pose(drive_.truth[i]);
    m.map_base_position[0] += 0.02 * static_cast<double>(i % 50);
    switch (i / 5 % 4) {
      case 0:
        m.flags |= map_pose_t::LOST;  // found again perhaps, or somewhere that looks like it
        break;
      case 1:
        m.flags = 0;
        break;
      case 2:
        m.covariance[7] = 4.0F;
        break;
      default:
        m.map_base_position[1] = std::numeric_limits<double>::infinity();
        break;
    }
    rig.send("MAP_POSE", m);
  }
  alone.finish();
  rig.finish();
  EXPECT_TRUE(rig.bytes == alone.bytes);
  const NodeReport report = rig.node.report();
  for (const char* cause : {"lost", "not_registered", "uncertain", "not_finite"})
    EXPECT_GT(report.counters["refused." + std::string(cause) + ".map"], 80) << cause;
  EXPECT_EQ(report.counters["map.used"], 0);
}

}  // namespace
}  // namespace curbstone::ekf
