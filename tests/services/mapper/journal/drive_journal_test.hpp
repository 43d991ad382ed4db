#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "services/mapper/journal/drive_journal.hpp"
#include "services/mapper/journal/journal_file.hpp"
#include "tests/services/mapper/dense_map/ground_patch.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::journal {

using dense_map::kPeriod;
using dense_map::kStart;
using dense_map::patch;

inline constexpr std::size_t kMaxBytes = 50'000'000;  // bytes

/// A drive along x at 2 m/s, that sees a patch of ground of `size` m about itself.
class DriveJournalTest : public ::testing::Test {
 protected:
  void drive(int revolutions, double size = 2) {
    for (int i = 0; i < revolutions; ++i) {
      revolve(size);
      write();
    }
  }
  void revolve(double size) {
    utime_ += kPeriod;
    const Pose T_map_base(Eigen::Translation3d(0.1 * ++revolution_, 0, 0));
    const std::vector<scan::LidarPoint> points = patch(0, 0, 0, size);
    map_.set_anchor(atlas_.visit(utime_, T_map_base, points));
    for (const TileKey& key : map_.insert(points, T_map_base, utime_)) changed_.push_back(key);
    RecordedPose pose{utime_, revolution_, atlas_.reference(), T_map_base, Pose(Eigen::Translation3d(1, 2, 3))};
    pose.with_odometry = true;
    pose.standing_since = kStart;
    pose.has_moved = true;
    journal_.add(pose);
    last_pose_ = utime_;
  }
  void write() { journal_.write(map_, atlas_, std::exchange(changed_, {}), map_.take_evicted(), utime_); }
  /// Until the file has all.
  void settle() {
    wait_until([this] { return is_up_to_date(); });
  }
  void wait_until(const std::function<bool()>& condition) {
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > limit) throw std::runtime_error("the journal never has it");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      write();
    }
  }
  [[nodiscard]] bool is_up_to_date() const {
    if (!age_of_journal(file_)) return false;
    const auto drive = read();
    return drive && drive->epoch == epoch_ && drive->poses.back().utime >= last_pose_ &&
           drive->tiles.size() == tiles().size() &&
           std::all_of(drive->tiles.begin(), drive->tiles.end(), [this](const auto& recorded) {
             const dense_map::DenseTile* tile = map_.tile(recorded.first);
             return tile != nullptr && tile->num_records() == recorded.second.content.records.size();
           });
  }
  /// That hold something.
  [[nodiscard]] std::vector<TileKey> tiles() const {
    std::vector<TileKey> keys = map_.keys();
    std::erase_if(keys, [this](TileKey key) { return map_.tile(key)->num_records() == 0; });
    return keys;
  }
  void start_epoch(std::int32_t epoch, std::vector<RecordedPose> drive) {
    epoch_ = epoch;
    journal_.start_epoch(epoch, std::move(drive));
  }
  [[nodiscard]] std::optional<RecordedDrive> read() const { return read_journal(file_, kMaxBytes, "settings"); }

  void expect_all(const RecordedDrive& drive) const {
    EXPECT_EQ(drive.epoch, 7);
    ASSERT_EQ(static_cast<int>(drive.nodes.size()), atlas_.size());
    for (int i = 0; i < atlas_.size(); ++i) {
      const RecordedNode& node = drive.nodes[static_cast<std::size_t>(i)];
      EXPECT_EQ(node.kept.utime, atlas_.node(i).utime);
      EXPECT_EQ(node.kept.T_map_base.matrix(), atlas_.node(i).T_map_base.matrix());
      EXPECT_EQ(node.kept.points, atlas_.node(i).points);
      EXPECT_EQ(node.driven, atlas_.driven(i));
    }
    ASSERT_EQ(drive.edges.size(), atlas_.edges().size());
    for (std::size_t i = 0; i < drive.edges.size(); ++i) {
      EXPECT_EQ(drive.edges[i].from, atlas_.edges()[i].from);
      EXPECT_EQ(drive.edges[i].to, atlas_.edges()[i].to);
      EXPECT_EQ(drive.edges[i].T_from_to.matrix(), atlas_.edges()[i].T_from_to.matrix());
      EXPECT_EQ(drive.edges[i].information, atlas_.edges()[i].information);
    }
    EXPECT_EQ(drive.tiles.size(), tiles().size());
    for (const TileKey& key : tiles()) {
      const RecordedTile& tile = drive.tiles.at(key);
      EXPECT_EQ(tile.z_origin, map_.tile(key)->z_origin());
      EXPECT_EQ(tile.content, *map_.tile(key)->read());
    }
    const RecordedPose& last = drive.poses.back();
    EXPECT_EQ(last.utime, utime_);
    EXPECT_EQ(last.revolution, revolution_);
    EXPECT_EQ(last.node, atlas_.reference());
    EXPECT_EQ(last.T_map_base.translation().x(), 0.1 * revolution_);
    EXPECT_EQ(last.T_map_odom.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(last.with_odometry);
    EXPECT_EQ(last.standing_since, kStart);
    EXPECT_TRUE(last.has_moved);
  }

  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "state/drive.journal";
  dense_map::DenseMap map_{config::DenseConfig{}};
  pose_graph::Atlas atlas_{config::AtlasConfig{}};
  DriveJournal journal_{file_, kMaxBytes, "settings"};
  std::vector<TileKey> changed_;
  std::int32_t epoch_ = 0;
  std::int64_t utime_ = kStart;
  std::int64_t last_pose_ = 0;  // us
  std::int32_t revolution_ = 0;
};

}  // namespace curbstone::mapper::journal
