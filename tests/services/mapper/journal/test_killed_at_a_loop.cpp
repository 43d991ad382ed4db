#include <gmock/gmock.h>

#include "tests/services/mapper/journal/killed_mapper.hpp"
#include "tests/services/mapper/round_street.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

/// Scans after the one that closes the loop at which the mapper is killed, together with the lidar driver: while the
/// map still moves, so that the successor has the drive as it was before; within what is mapped again; and later.
class KilledAtALoopTest : public KilledMapperTest, public ::testing::WithParamInterface<int> {
 protected:
  KilledAtALoopTest() {
    world_ = test::round_street();
    trajectory_ = test::around;
    test::forget_soon(config_);
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
  EXPECT_THAT(node_->report().faults, Each(HasSubstr("s of the drive are missing")));
}

INSTANTIATE_TEST_SUITE_P(Scans, KilledAtALoopTest, ::testing::Values(0, 10, 30));

}  // namespace
}  // namespace curbstone::mapper::journal
