#include <gmock/gmock.h>

#include <algorithm>

#include "tests/services/mapper/journal/killed_mapper.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::IsEmpty;

constexpr int kStandingScans = 30;

/// Scans after the first one at which the mapper is killed: while it stands, setting off, when the map of the
/// standstill has just given way to the drive's own, and later.
class KilledAtTheStartTest : public KilledMapperTest, public ::testing::WithParamInterface<int> {
 protected:
  KilledAtTheStartTest() {
    trajectory_ = [](double t) { return test::driving(std::max(0.0, t - kStandingScans * test::kPeriod)); };
  }
};

TEST_P(KilledAtTheStartTest, IsSucceededInTheSameFrame) {
  start_mapper();
  drive(GetParam());
  kill_mapper();
  drive(4);
  start_mapper();
  drive(110 - turn_);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_EQ(counter("resumed.lost"), 0) << "odometry leads on from the last pose";
  EXPECT_LT(error(), 0.1);
  EXPECT_FALSE(node_->mapper().shows_start());
  node_->tick(test::utime(100));
  EXPECT_GT(node_->mapper().grown().size(), 10'000);
  ASSERT_FALSE(pages_.empty());
  EXPECT_EQ(pages_.back().utimes.front(), poses_.front().utime) << "the drive since its beginning";
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Scans, KilledAtTheStartTest, ::testing::Values(15, 33, 45, 56, 75));

}  // namespace
}  // namespace curbstone::mapper::journal
