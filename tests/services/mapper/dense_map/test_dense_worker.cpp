#include "services/mapper/dense_map/dense_worker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tests/services/mapper/dense_map/ground_patch.hpp"

namespace curbstone::mapper::dense_map {
namespace {

/// A patch of ground about x m ahead.
scan::SharedPoints ground(double x) {
  return std::make_shared<const std::vector<scan::LidarPoint>>(patch(x, 0, 0.01, 4.0));
}

DenseWork work(int n, const scan::SharedPoints& points) {
  DenseWork work;
  work.insertions.push_back({points, Pose::Identity(), kStart + n * kPeriod, 0, true});
  work.removal = DenseWork::FreeSpaceRemoval{{}, {true}, false};
  return work;
}

/// With a second thread and without.
class WorkOnTheMap : public testing::TestWithParam<bool> {
 protected:
  void grow(int scans, double x = 5) {
    const scan::SharedPoints points = ground(x);
    for (int i = 0; i < scans; ++i) worker_.begin(work(n_++, points));
  }
  config::DenseConfig config_;
  DenseWorker worker_{config_, Pose(Eigen::Translation3d(0, 0, 1.5)), GetParam()};
  int n_ = 0;
};

TEST_P(WorkOnTheMap, IsNotSeenBeforeItIsWaitedFor) {
  grow(1);
  EXPECT_THROW((void)worker_.grown(), std::logic_error);
  EXPECT_THROW((void)worker_.map(), std::logic_error);
  EXPECT_THROW((void)worker_.take_evicted(), std::logic_error);
  EXPECT_TRUE(worker_.take_changed().empty());
}

TEST_P(WorkOnTheMap, GrowsFirstAndIsLookedThroughLater) {
  grow(5);
  worker_.wait_inserted();
  EXPECT_GT(worker_.grown().size(), 1000);
  EXPECT_FALSE(worker_.take_changed().empty());
  EXPECT_THROW((void)worker_.map(), std::logic_error) << "the look has not begun";
  worker_.begin_free_space_removal();
  EXPECT_THROW((void)worker_.grown(), std::logic_error) << "the look is under way";
  worker_.wait();
  EXPECT_EQ(&worker_.map(), &worker_.grown());
  EXPECT_GT(worker_.counters()["dense.points"], 1000);
}

TEST_P(WorkOnTheMap, NothingIsUnderWayAtFirstAndWaitingTwiceIsNothing) {
  EXPECT_EQ(worker_.map().size(), 0);
  worker_.begin_free_space_removal();
  worker_.wait();
  worker_.wait();
  EXPECT_EQ(worker_.map().size(), 0);
  EXPECT_EQ(worker_.num_removals(), 0);
}

TEST_P(WorkOnTheMap, MovesWithTheNextScanBesideTheCaller) {
  const std::vector<Pose> corrections{Pose(Eigen::Translation3d(0.5, 0.2, 0))};
  DenseMap expected(config_);
  expected.set_anchor(0);
  for (int i = 0; i < 5; ++i) expected.insert(*ground(5), Pose::Identity(), kStart + i * kPeriod);
  grow(5);
  worker_.wait();
  ASSERT_EQ(worker_.map().keys(), expected.keys());
  (void)worker_.take_changed();

  worker_.move(corrections);
  EXPECT_TRUE(worker_.is_moving());
  EXPECT_EQ(worker_.grown().size(), expected.size()) << "not in the call itself";
  expected.move(corrections);
  grow(1);
  expected.insert(*ground(5), Pose::Identity(), kStart + 5 * kPeriod);
  worker_.wait_inserted();
  EXPECT_FALSE(worker_.is_moving());
  ASSERT_EQ(worker_.grown().keys(), expected.keys());
  const std::vector<TileKey> changed = worker_.take_changed();
  for (const TileKey& key : expected.keys()) {
    EXPECT_EQ(worker_.grown().tile(key)->read()->points(), expected.tile(key)->read()->points());
    EXPECT_NE(std::find(changed.begin(), changed.end(), key), changed.end());
  }
}

TEST_P(WorkOnTheMap, EveryTileThatChangesIsReported) {
  grow(5);
  grow(5, 11);
  worker_.wait();
  std::vector<TileKey> changed = worker_.take_changed();
  for (const TileKey& key : worker_.finish()) changed.push_back(key);
  for (const TileKey& key : worker_.map().keys()) {
    if (worker_.map().tile(key)->num_points() == 0) continue;
    EXPECT_NE(std::find(changed.begin(), changed.end(), key), changed.end()) << key.x << " " << key.y;
  }
  EXPECT_TRUE(worker_.take_changed().empty());
}

TEST_P(WorkOnTheMap, ComesBeforeTheMapIsChanged) {
  grow(5);
  worker_.move({Pose(Eigen::Translation3d(0, 0, 5))});
  worker_.wait();
  const DenseMap& moved = worker_.map();
  ASSERT_GT(moved.size(), 1000);
  for (const Eigen::Vector3d& p : all_points(moved)) EXPECT_NEAR(p.z(), 5.01, 0.01);
  worker_.roll_back(kStart - 2'000'000);
  EXPECT_EQ(worker_.map().size(), 0);
}

TEST_P(WorkOnTheMap, IsEndedWithItsOwner) {
  grow(3);  // the destructor waits for a thread, and drops what has not begun
}

INSTANTIATE_TEST_SUITE_P(DenseWorker, WorkOnTheMap, testing::Bool(),
                         [](const auto& worker) { return worker.param ? "Beside" : "WithinTheWait"; });

TEST(DenseWorker, MakesTheSameMapWithAThreadAndWithoutAndWheneverItIsLookedThrough) {
  const config::DenseConfig config;
  const Pose T_base_lidar(Eigen::Translation3d(0, 0, 1.5));
  DenseWorker beside(config, T_base_lidar, true), within(config, T_base_lidar, false);
  const scan::SharedPoints near = ground(5), far = ground(7);
  for (int i = 0; i < 20; ++i) {
    for (DenseWorker* worker : {&beside, &within}) worker->begin(work(i, i < 10 ? near : far));
    if (i % 3 == 0) beside.begin_free_space_removal();
    if (i % 5 == 0) within.wait();
  }
  beside.wait();
  within.wait();
  EXPECT_EQ(beside.num_removals(), within.num_removals());
  ASSERT_EQ(beside.map().keys(), within.map().keys());
  for (const TileKey& key : beside.map().keys()) {
    EXPECT_TRUE(beside.map().tile(key)->read()->records == within.map().tile(key)->read()->records)
        << key.x << " " << key.y;
  }
}

}  // namespace
}  // namespace curbstone::mapper::dense_map
