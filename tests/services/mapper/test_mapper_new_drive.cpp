#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/config/config.hpp"
#include "common/tile_sync/drive_pages.hpp"
#include "services/mapper/journal/journal_file.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/mounting/avenue.hpp"
#include "tests/services/mapper/round_street.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper {
namespace {

using test::kPeriod;
using test::utime;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kSeen = 40;     // scans of a street, at 3 m/s;
constexpr int kBlind = 160;   // then none for 8 s;
constexpr double kPace = 3;   // m/s on the round street, where the vehicle is then
constexpr double kAgain = 8;  // s, by when odometry is there again, in a new frame

Pose slowly_around(double t) {
  return test::around(t * kPace / test::kSpeed);
}

/// All sensors are silent while a vehicle drives into a street that it has never seen.
struct BlindDrive : test::MapperDrive {
  BlindDrive() {
    with_odometry(kSeen * kPeriod);
    for (int i = 0; i < kSeen; ++i) (void)step();
    turn += kBlind;
    world = test::round_street();
    trajectory = slowly_around;
  }
  void odometry_again(double until) {
    for (double t = kAgain; t < until; t += 0.01)
      odometry.add({utime(t), slowly_around(kAgain).inverse() * slowly_around(t), true, false});
  }
  /// s until the vehicle is given up, of 26.
  double given_up_after() {
    for (int i = 0; i < 520; ++i) {
      const auto update = step();
      if (update && update->wants_new_drive) return i * kPeriod;
    }
    return 26;
  }
};

TEST(MapperNewDrive, IsWantedWhereTheVehicleIsOutOfSightOfItsMapAndNothingToldHowItCameThere) {
  BlindDrive drive;
  drive.odometry_again(40);
  const std::int64_t points = drive.dense().size();
  EXPECT_NEAR(drive.given_up_after(), 12, 0.3);
  EXPECT_EQ(drive.mapper->fix(), tracking::Fix::kLost);
  EXPECT_GE(drive.mapper->counters()["searches"], 6);
  EXPECT_EQ(drive.mapper->counters()["searches.found"], 0);
  EXPECT_GT(drive.dense().size(), points) << "what waited for more scans has gone in, as at the end of a drive";
}

TEST(MapperNewDrive, IsWantedLaterWhereNothingTellsHowFarItGoes) {
  BlindDrive drive;
  EXPECT_NEAR(drive.given_up_after(), 24, 0.3);
}

TEST(MapperNewDrive, IsNotWantedWhileItStands) {
  BlindDrive drive;
  for (double t = kAgain; t < 40; t += 0.01) drive.odometry.add({utime(t), Pose::Identity(), true, true});
  drive.trajectory = [](double) { return slowly_around(kAgain); };
  EXPECT_EQ(drive.given_up_after(), 26);
}

TEST(MapperNewDrive, IsNeverWantedOnAMapThatWasLoaded) {
  test::MapperDrive first;
  first.with_odometry(5);
  for (int i = 0; i < kSeen; ++i) (void)first.step();
  first.mapper->wait();
  BlindDrive drive;
  drive.config.mode = config::MapMode::kExtend;
  drive.mapper.emplace(drive.config);
  drive.mapper->load(first.mapper->saved(7));
  drive.odometry_again(40);
  EXPECT_EQ(drive.given_up_after(), 26);
}

/// The same, with a mapper on a bus.
class MapperNodeNewDrive : public ::testing::Test {
 protected:
  /// A mapper with a bus of its own; one that was there is gone as if it had been killed.
  void start() {
    node_.reset();
    bus_ = std::make_unique<LocalBus>();
    bus_->subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { poses_.push_back(m); });
    bus_->subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) {
      if (m.channel == kDriveChannel) announced_[m.epoch] = std::accumulate(m.version.begin(), m.version.end(), 0);
    });
    node_ = std::make_unique<MapperNode>(config_, *bus_);
    node_->connect(*bus_);
  }
  void drive(int scans, const test::SyntheticWorld& world, const test::SyntheticWorld::Trajectory& trajectory) {
    for (int i = 0; i < scans; ++i) {
      const int n = turn_++;
      for (; odometry_sent_ < (n + 1) * kPeriod + 0.02; odometry_sent_ += 0.01) {
        odometry_t m{};
        m.utime = utime(odometry_sent_);
        m.flags = odometry_t::INITIALISED;
        pose_to_arrays(trajectory(odometry_began_).inverse() * trajectory(odometry_sent_), m.position, m.orientation);
        bus_->publish("ODOMETRY", m);
      }
      const Pose T_base_lidar = config_.vehicle.T_base_lidar() * test::pose(0, 0, 0, lidar_roll_, 0, 0) *
                                test::pose(0, 0, 0, 0, 0, lidar_yaw_);
      for (const auto& packet : world.packets(trajectory, T_base_lidar, n, n * kPeriod, kPeriod))
        bus_->publish("LIDAR_POINTS", packet);
      bus_->dispatch();
      for (int k = 0; k < 2; ++k) node_->tick(utime(n * kPeriod + 0.02 * k));
      bus_->dispatch();
    }
  }
  /// All sensors are silent while the vehicle drives into a street that it has never seen, and along it for a while.
  void drive_out_of_sight(int scans) {
    drive(kSeen, test::street(), test::driving);
    epoch_before_ = poses_.back().epoch;
    turn_ += kBlind;
    odometry_began_ = odometry_sent_ = turn_ * kPeriod - 0.1;
    drive(scans, elsewhere_, slowly_around);
  }

  test::TemporaryFolder folder_;
  config::MapperConfig config_;
  std::unique_ptr<LocalBus> bus_;
  std::unique_ptr<MapperNode> node_;
  const test::SyntheticWorld elsewhere_ = test::round_street();
  std::vector<map_pose_t> poses_;
  std::map<std::int32_t, int> announced_;  // poses of the drive, in each epoch
  std::int32_t epoch_before_ = 0;
  int turn_ = 0;
  double lidar_yaw_ = 0, lidar_roll_ = 0;  // rad, that the file does not know
  double odometry_began_ = 0;
  double odometry_sent_ = -0.1;
};

TEST_F(MapperNodeNewDrive, IsAnotherMapInAFrameOfItsOwnAndTheEarlierOneStays) {
  config_.folder = (folder_.path() / "map").string();
  start();
  drive_out_of_sight(320);
  const NodeReport report = node_->report();
  EXPECT_EQ(report.counters["new_drives"], 1);
  EXPECT_EQ(report.counters["lost.blind"], 1) << "what the first mapper counted is not forgotten";
  EXPECT_THAT(report.faults, Contains(HasSubstr("a new map begins: the vehicle was lost")));
  node_->finish();
  bus_->dispatch();
  EXPECT_EQ(node_->report().counters["dense.points"], node_->mapper().dense().size()) << "of this map alone";

  EXPECT_GT(announced_[epoch_before_], 0);
  EXPECT_LE(announced_[epoch_before_], kSeen) << "no guess is announced as a pose of the drive";
  const map_pose_t& last = poses_.back();
  EXPECT_EQ(last.flags & map_pose_t::LOST, 0);
  const auto first = std::find_if(poses_.begin(), poses_.end(), [&](const auto& p) { return p.epoch > epoch_before_; });
  ASSERT_NE(first, poses_.end());
  EXPECT_EQ(std::prev(first)->flags & map_pose_t::LOST, map_pose_t::LOST);
  const auto truth = [](const map_pose_t& p) {
    return slowly_around(static_cast<double>(p.utime - test::SyntheticWorld::kEpoch) * 1e-6);
  };
  const auto moved = [](const Pose& from, const Pose& to) { return from.inverse() * to; };
  const Pose driven = moved(pose_from_arrays(first->map_base_position, first->map_base_orientation),
                            pose_from_arrays(last.map_base_position, last.map_base_orientation));
  EXPECT_LT(moved(moved(truth(*first), truth(last)), driven).translation().norm(), 0.1);

  std::size_t kept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    const storage::SavedMap map = storage::load_map(entry.path());
    const bool is_earlier = entry.path().filename() != "map";
    EXPECT_EQ(map.epoch > epoch_before_, !is_earlier);
    EXPECT_GT(map.tiles.size(), 5U);
    EXPECT_EQ(map.nodes.back().utime < utime(kAgain), is_earlier) << "each knows its own drive alone";
    ++kept;
  }
  EXPECT_EQ(kept, 2U);
}

/// Odometry leads through the avenue, and nothing else does.
TEST_F(MapperNodeNewDrive, IsBegunWithTheLidarTurnedWhereItLooksAsideFromTheStart) {
  for (const double degrees : {3.0, 180.0}) {
    poses_.clear();
    turn_ = 0;
    odometry_sent_ = -0.1;
    lidar_yaw_ = degrees * std::numbers::pi / 180;
    start();
    drive(120, test::avenue(40), [](double t) { return test::pose(3 * t, 0, 0, 0, 0, 0); });
    const NodeReport report = node_->report();
    EXPECT_GE(report.counters["lidar_turned"], 1) << degrees;
    EXPECT_EQ(report.counters["new_drives"], report.counters["lidar_turned"]);
    EXPECT_THAT(report.faults, Contains(HasSubstr("of what vehicle.lidar says, and is used so"))) << degrees;
    const map_pose_t& last = poses_.back();
    const auto first =
        std::find_if(poses_.begin(), poses_.end(), [&](const auto& pose) { return pose.epoch == last.epoch; });
    EXPECT_EQ(last.flags & map_pose_t::LOST, 0);
    const Pose driven = pose_from_arrays(first->map_base_position, first->map_base_orientation).inverse() *
                        pose_from_arrays(last.map_base_position, last.map_base_orientation);
    const double metres = 3e-6 * static_cast<double>(last.utime - first->utime);
    EXPECT_GT(metres, 4.0);
    EXPECT_NEAR(driven.translation().x(), metres, 0.3) << degrees;
    EXPECT_NEAR(driven.translation().y(), 0.0, 0.05) << degrees;
    EXPECT_LT(angle_of(driven), 0.01) << degrees;
  }
}

TEST_F(MapperNodeNewDrive, IsBegunWithTheLidarTurnedOverWhereItHangsUpsideDown) {
  lidar_roll_ = std::numbers::pi;
  start();
  drive(140, test::street(), [](double t) { return test::pose(0.5 * t, 0, 0, 0, 0, 0); });
  const NodeReport report = node_->report();
  EXPECT_EQ(report.counters["lidar_turned_over"], 1);
  EXPECT_EQ(report.counters["lidar_turned"], 0);
  EXPECT_THAT(report.faults, Contains(HasSubstr("upside down by what vehicle.lidar says, and is used so")));
  EXPECT_EQ(poses_.back().flags & map_pose_t::LOST, 0);
  const Pose T_map_base = pose_from_arrays(poses_.back().map_base_position, poses_.back().map_base_orientation);
  EXPECT_LT(angle_of(T_map_base), 0.02) << "base_link is the right way up";
}

TEST_F(MapperNodeNewDrive, IsNotBegunWhereTheLidarLooksAhead) {
  start();
  drive(80, test::avenue(40), [](double t) { return test::pose(3 * t, 0, 0, 0, 0, 0); });
  EXPECT_EQ(node_->report().counters["new_drives"], 0);
}

TEST_F(MapperNodeNewDrive, IsWhatTheJournalIsOf) {
  config_.journal = (folder_.path() / "journal").string();
  start();
  drive_out_of_sight(300);
  const std::int32_t epoch = poses_.back().epoch;
  EXPECT_GT(epoch, epoch_before_);
  node_.reset();  // as if it had been killed
  ConfigOf<config::MapperConfig> config;
  config.value = config_;
  const auto kept = journal::read_journal(config_.journal, 100'000'000, config_hash("mapper", config), nullptr);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->epoch, epoch);
  EXPECT_GT(kept->poses.front().utime, utime(kAgain + 10));
}

}  // namespace
}  // namespace curbstone::mapper
