#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>

#include "tests/services/mapper/journal/killed_mapper.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::IsEmpty;

constexpr double kRadius = 26;  // m: once around is more than the least loop
constexpr double kSpeed = 12;   // m/s

Pose around(double t) {
  const double angle = kSpeed / kRadius * t;
  return test::pose(kRadius * std::cos(angle), kRadius * std::sin(angle), 0, 0, 0, angle + M_PI / 2);
}

/// Boxes of many sizes within and without the round street: no place looks like another.
test::SyntheticWorld round_street() {
  test::SyntheticWorld world;
  world.noise = 0.01;
  std::uint32_t state = 7;
  const auto random = [&](double low, double high) {
    state = state * 1664525U + 1013904223U;
    return low + (high - low) * (state >> 8) / 16777216.0;
  };
  for (const double side : {-1.0, 1.0}) {
    for (double angle = 0; angle < 2 * M_PI; angle += random(0.12, 0.3)) {
      const double r = kRadius + side * random(5, 8);
      const Eigen::Vector3d place(r * std::cos(angle), r * std::sin(angle), 0);
      const double width = random(0.3, 1.5);
      const double depth = random(0.3, 1.5);
      world.boxes.push_back(
          {place - Eigen::Vector3d(width, depth, 0), place + Eigen::Vector3d(width, depth, random(1, 5))});
    }
  }
  return world;
}

/// Scans after the one that closes the loop at which the mapper is killed, together with the lidar driver: while the
/// map still moves, so that the successor has the drive as it was before; within what is mapped again; and later.
class KilledAtALoopTest : public KilledMapperTest, public ::testing::WithParamInterface<int> {
 protected:
  KilledAtALoopTest() {
    world_ = round_street();
    trajectory_ = around;
    config_.registration.icp.window = 25;
    config_.registration.icp.max_range = 25;
    config_.loop.rearrange_m = 0;
  }
};

TEST_P(KilledAtALoopTest, IsSucceededWhereOdometryLeadsFromItsLastPose) {
  start_mapper();
  while (counter("loops.closed") == 0 && turn_ < 350) step();
  ASSERT_EQ(counter("loops.closed"), 1);
  ASSERT_EQ(counter("epochs"), 2);
  drive(GetParam());
  if (GetParam() == 0)
    kill_mapper_at_once();
  else
    kill_mapper();
  drive(6);
  start_driver();  // what it had sent since then is not to be had
  start_mapper();
  drive(3);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_EQ(counter("resumed.lost"), 0);
  EXPECT_EQ(poses_.back().flags & map_pose_t::LOST, 0);
  EXPECT_LT(error(), 0.1);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Scans, KilledAtALoopTest, ::testing::Values(0, 10, 30));

}  // namespace
}  // namespace curbstone::mapper::journal
