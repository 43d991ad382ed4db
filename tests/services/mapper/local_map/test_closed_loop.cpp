#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <vector>

#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/round_street.hpp"

/// @file
/// A mapper that comes back to its first place.

namespace curbstone::mapper::local_map {
namespace {

constexpr int kScans = 290;        // once around, until the loop is closed and the map has moved
constexpr int kScansToSolve = 10;  // from the scan that finds the loop to the one that moves the map

using Tiles = std::map<TileKey, std::vector<TilePoint>>;

/// The scans of the drive, and odometry.
struct RoundDrive : test::MapperDrive {
  std::vector<scan::Scan> scans;

  RoundDrive() {
    world = test::round_street();
    trajectory = test::around;
    test::forget_soon(config);
    with_odometry(kScans * test::kPeriod + 0.1);
    for (int i = 0; i < kScans; ++i) scans.push_back(next());
  }
  static const RoundDrive& once() {
    static const RoundDrive drive;
    return drive;
  }
};

/// What a mapper makes of it.
struct Outcome {
  std::vector<Pose> poses;
  int found = 0;
  int moved = 0;
  Tiles tiles;
};

class ClosedLoopTest : public ::testing::Test {
 protected:
  void begin(int threads) {
    config::MapperConfig config = drive_.config;
    config.threads = threads;
    mapper_.emplace(config);
  }
  Outcome drive() {
    Outcome outcome;
    for (int i = 0; i < kScans; ++i) {
      const auto update = mapper_->process(drive_.scans[static_cast<std::size_t>(i)], drive_.odometry);
      if (!update) continue;
      outcome.poses.push_back(update->T_map_base);
      if (outcome.found == 0 && is_found()) outcome.found = i;
      if (update->rearranged) outcome.moved = i;
    }
    (void)mapper_->finish();
    for (const TileKey& key : mapper_->dense().keys())
      outcome.tiles[key] = mapper_->dense().tile(key)->read()->points();
    return outcome;
  }
  [[nodiscard]] bool is_found() const { return mapper_->counters()["loops.seen"] == 2; }

  const RoundDrive& drive_ = RoundDrive::once();
  std::optional<Mapper> mapper_;
};

TEST_F(ClosedLoopTest, IsSolvedBesideTheScansAndMovesTheMapAtOneOfThemWhateverTheTiming) {
  begin(2);
  const Outcome beside = drive();
  EXPECT_EQ(mapper_->counters()["loops.closed"], 1);
  ASSERT_GT(beside.found, 0);
  EXPECT_EQ(beside.moved - beside.found, kScansToSolve);
  begin(1);
  const Outcome alone = drive();
  EXPECT_EQ(alone.found, beside.found);
  EXPECT_EQ(alone.moved, beside.moved);
  EXPECT_EQ(alone.tiles, beside.tiles);
  ASSERT_EQ(alone.poses.size(), beside.poses.size());
  for (std::size_t i = 0; i < alone.poses.size(); ++i)
    ASSERT_EQ(alone.poses[i].matrix(), beside.poses[i].matrix()) << i << ": bit for bit";
}

TEST_F(ClosedLoopTest, IsClosedAtTheEndOfADriveThatEndsMeanwhile) {
  begin(2);
  EXPECT_FALSE(mapper_->close_last_loop());
  for (const scan::Scan& scan : drive_.scans) {
    (void)mapper_->process(scan, drive_.odometry);
    if (is_found()) break;
  }
  ASSERT_TRUE(is_found());
  EXPECT_EQ(mapper_->counters()["loops.closed"], 0);
  EXPECT_TRUE(mapper_->close_last_loop());
  EXPECT_EQ(mapper_->counters()["loops.closed"], 1);
  (void)mapper_->finish();
  EXPECT_GT(mapper_->dense().size(), 100'000);
  EXPECT_FALSE(mapper_->dense().is_moving());
}

}  // namespace
}  // namespace curbstone::mapper::local_map
