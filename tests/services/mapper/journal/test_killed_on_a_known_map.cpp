#include <gmock/gmock.h>

#include "tests/services/mapper/journal/killed_mapper.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::IsEmpty;

/// A second drive on the map of the first.
class KilledOnAKnownMapTest : public KilledMapperTest, public ::testing::WithParamInterface<config::MapMode> {
 protected:
  void SetUp() override {
    config_.folder = folder_ / "site";
    start_mapper();
    drive(60);
    node_->finish();
    rings_ = node_->mapper().rings();
    node_.reset();
    poses_.clear();
    pages_.clear();
    turn_ = 0;
    odometry_sent_ = -0.1;
    config_.mode = GetParam();
    start_mapper();
    EXPECT_EQ(node_->mapper().rings(), rings_) << "one scale of intensities";
    drive(50);
  }
  intensity::RingHistograms rings_;
};

TEST_P(KilledOnAKnownMapTest, IsSucceededInTheFrameOfTheMap) {
  ASSERT_EQ(poses_.back().flags & map_pose_t::LOST, 0) << "found where the map begins";
  ASSERT_LT(error(), 0.15);
  const std::int64_t points = counter("dense.points");
  const std::int32_t epoch = poses_.back().epoch;
  kill_mapper();
  drive(6);
  start_mapper();
  drive(3);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_EQ(poses_.back().flags & map_pose_t::LOST, 0);
  EXPECT_NE(poses_.back().flags & map_pose_t::REGISTERED, 0);
  EXPECT_LT(error(), 0.15);
  EXPECT_GT(poses_.back().epoch, epoch);
  node_->tick(test::utime(100));
  EXPECT_GT(static_cast<double>(node_->mapper().grown().size()), 0.97 * static_cast<double>(points))
      << "the map of the first drive too";
  drive(15);
  EXPECT_LT(error(), 0.15);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_P(KilledOnAKnownMapTest, LeavesTheMapOnTheDiskWhole) {
  kill_mapper();
  drive(6);
  start_mapper();
  drive(20);
  node_->finish();
  node_.reset();
  turn_ = 0;
  odometry_sent_ = -0.1;
  config_.mode = config::MapMode::kLocalise;
  start_mapper();
  drive(20);
  EXPECT_EQ(poses_.back().flags & map_pose_t::LOST, 0);
  EXPECT_LT(error(), 0.15);
}

INSTANTIATE_TEST_SUITE_P(Modes, KilledOnAKnownMapTest,
                         ::testing::Values(config::MapMode::kExtend, config::MapMode::kLocalise), [](const auto& mode) {
                           return mode.param == config::MapMode::kExtend ? "Extend" : "Localise";
                         });

}  // namespace
}  // namespace curbstone::mapper::journal
