#include "services/mapper/journal/drive_journal.hpp"

#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "services/mapper/journal/journal_file.hpp"
#include "tests/services/mapper/dense_map/ground_patch.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::journal {
namespace {

using dense_map::kPeriod;
using dense_map::kStart;
using dense_map::patch;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::size_t kMost = 50'000'000;  // bytes

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
             return tile != nullptr && tile->records().size() == recorded.second.records.size();
           });
  }
  /// That hold something.
  [[nodiscard]] std::vector<TileKey> tiles() const {
    std::vector<TileKey> keys = map_.keys();
    std::erase_if(keys, [this](TileKey key) { return map_.tile(key)->records().empty(); });
    return keys;
  }
  void start_epoch(std::int32_t epoch, std::vector<RecordedPose> drive) {
    epoch_ = epoch;
    journal_.start_epoch(epoch, std::move(drive));
  }
  [[nodiscard]] std::optional<RecordedDrive> read() const { return read_journal(file_, kMost, "settings"); }

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
      EXPECT_EQ(tile.records, map_.tile(key)->records());
      ASSERT_EQ(tile.runs.size(), map_.tile(key)->runs().size());
      for (std::size_t i = 0; i < tile.runs.size(); ++i) {
        EXPECT_EQ(tile.runs[i].anchor, map_.tile(key)->runs()[i].anchor);
        EXPECT_EQ(tile.runs[i].first, map_.tile(key)->runs()[i].first);
        EXPECT_EQ(tile.runs[i].utime, map_.tile(key)->runs()[i].utime);
      }
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
  DriveJournal journal_{file_, kMost, "settings"};
  std::vector<TileKey> changed_;
  std::int32_t epoch_ = 0;
  std::int64_t utime_ = kStart;
  std::int64_t last_pose_ = 0;  // us
  std::int32_t revolution_ = 0;
};

TEST_F(DriveJournalTest, HoldsAllOfTheDriveBitForBit) {
  start_epoch(7, {});
  drive(30);
  intensity::RingHistograms rings{40, {{}, {}}};
  rings.rings[1][64] = 12'345;
  journal_.set_rings(rings);
  drive(30);
  settle();
  ASSERT_TRUE(read());
  expect_all(*read());
  EXPECT_EQ(read()->rings, rings);
  start_epoch(8, read()->poses);
  drive(1);
  settle();
  EXPECT_EQ(read()->rings, rings) << "an epoch later, too";
  EXPECT_THAT(journal_.fault(), IsEmpty());
}

TEST_F(DriveJournalTest, OfANewEpochTakesThePlaceOfTheOldOneOnceItIsWhole) {
  start_epoch(6, {});
  drive(120, 8);
  settle();
  ASSERT_EQ(read()->epoch, 6);
  const auto bytes = std::filesystem::file_size(file_);
  ASSERT_GT(bytes, 2U * 256 * 1024) << "more than two batches";
  start_epoch(7, read()->poses);
  revolve(8);
  write();
  while (std::filesystem::exists(file_ + ".unfinished") || read()->epoch == 6) {
    EXPECT_EQ(read()->epoch, std::filesystem::exists(file_ + ".unfinished") ? 6 : read()->epoch);
    write();
  }
  settle();
  expect_all(*read());
  EXPECT_EQ(read()->poses.size(), 121U);
}

TEST_F(DriveJournalTest, GrowsByNewGroundAndHardlyWhileStanding) {
  start_epoch(7, {});
  drive(40);
  settle();
  const auto bytes = std::filesystem::file_size(file_);
  RecordedPose pose = read()->poses.back();
  const auto stand = [&](int seconds) {
    for (int i = 0; i < 20 * seconds; ++i) {
      pose.utime = utime_ += kPeriod;
      journal_.add(pose);
      write();
    }
    last_pose_ = utime_ - 1'000'000;
    settle();
  };
  stand(60);
  EXPECT_GE(read()->poses.size(), 40U + 20 * 60) << "the whole drive, its stops too";
  const auto stopped = std::filesystem::file_size(file_);
  EXPECT_LT(stopped - bytes, 20 * 60 * 300U);
  stand(60);
  EXPECT_LT(std::filesystem::file_size(file_) - stopped, 60 * 300U) << "after a minute a pose a second";
}

TEST_F(DriveJournalTest, ShowsThatItsMapperLivesWhenThereIsNothingNew) {
  start_epoch(7, {});
  drive(10);
  settle();
  std::filesystem::last_write_time(file_, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_GT(*age_of_journal(file_), 3500);
  utime_ += 1'500'000;
  wait_until([this] { return *age_of_journal(file_) < 60; });
  EXPECT_TRUE(is_up_to_date());
}

TEST_F(DriveJournalTest, BeginsAnewWhenAFullDiskHasRoomAgain) {
  const std::string disk = std::filesystem::path(file_).parent_path();
  std::filesystem::create_directories(disk);
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=4m") != 0)
    GTEST_SKIP() << "no right to mount a small disk";
  start_epoch(7, {});
  drive(20);
  settle();
  const std::string ballast = disk + "/ballast";
  std::ofstream(ballast) << std::string(8'000'000, 'x') << std::flush;
  for (int i = 0; i < 3000 && journal_.fault().empty(); ++i) {
    drive(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_THAT(journal_.fault(), ::testing::HasSubstr("No space left"));
  std::ofstream(ballast, std::ios::app) << std::string(8'000'000, 'x') << std::flush;  // the journal's file is gone
  EXPECT_FALSE(journal_.wants_anew(utime_ + 5'000'000)) << "there is no room yet";
  std::filesystem::remove(ballast);
  EXPECT_FALSE(journal_.wants_anew(utime_ + 1'000'000));
  EXPECT_TRUE(journal_.wants_anew(utime_ + 3'000'000));
  start_epoch(7, {});
  drive(5);
  settle();
  EXPECT_THAT(journal_.fault(), IsEmpty());
  umount2(disk.c_str(), MNT_DETACH);
}

TEST_F(DriveJournalTest, CutAnywhereHoldsThatMuchOfTheDriveOrNothing) {
  start_epoch(7, {});
  drive(25);
  settle();
  const std::size_t whole = read()->poses.size();
  std::size_t most = 0;
  for (auto size = std::filesystem::file_size(file_); size > 0; size -= std::min<std::uintmax_t>(size, 997)) {
    std::filesystem::resize_file(file_, size);
    const auto drive = read();
    if (drive) most = std::max(most, drive->poses.size());
  }
  EXPECT_EQ(most, whole);
}

TEST_F(DriveJournalTest, DamagedAnywhereIsRefusedOrEndsThere) {
  start_epoch(7, {});
  drive(15);
  settle();
  std::ostringstream bytes;
  bytes << std::ifstream(file_, std::ios::binary).rdbuf();
  const std::string whole = bytes.str();
  const std::size_t poses = read()->poses.size();
  int refused = 0;
  int tried = 0;
  for (std::size_t at = 0; at < whole.size(); at += at < 400 ? 1 : 1009) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x41);
    std::ofstream(file_, std::ios::binary) << damaged;
    ++tried;
    try {
      const auto drive = read();
      EXPECT_LT(drive ? drive->poses.size() : 0, poses) << at;
    } catch (const JournalError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 2);
}

TEST_F(DriveJournalTest, TellsOfTilesThatWereGivenUp) {
  config::DenseConfig small;
  small.max_points = 100'000;
  map_ = dense_map::DenseMap(small);
  start_epoch(7, {});
  for (int i = 0; i < 1200; ++i) {
    revolve(6);
    if (i % 100 == 0) settle();
  }
  settle();
  ASSERT_GT(map_.counters()["dense.evicted_tiles"], 0);
  expect_all(*read());
}

TEST_F(DriveJournalTest, BegunAnewIsNoLargerThanWhatTheMapStillHolds) {
  config::DenseConfig small;
  small.max_points = 100'000;
  map_ = dense_map::DenseMap(small);
  start_epoch(7, {});
  while (!journal_.wants_anew(utime_)) drive(100, 6);
  settle();
  const auto bytes = std::filesystem::file_size(file_);
  start_epoch(7, read()->poses);
  EXPECT_FALSE(journal_.wants_anew(utime_));
  drive(1, 6);
  wait_until([&] { return std::filesystem::file_size(file_) < bytes; });
  settle();
  EXPECT_LT(std::filesystem::file_size(file_), bytes / 2 + 200'000);
  expect_all(*read());
}

TEST_F(DriveJournalTest, OfAMapperWithOtherSettingsIsRefused) {
  start_epoch(7, {});
  drive(10);
  settle();
  EXPECT_THROW((void)read_journal(file_, kMost, "other settings"), JournalError);
  EXPECT_THROW((void)read_journal(file_, 1000, "settings"), JournalError) << "larger than allowed";
}

TEST_F(DriveJournalTest, IsGoneWhenTheDriveIsOver) {
  start_epoch(7, {});
  drive(10);
  settle();
  journal_.remove();
  EXPECT_EQ(age_of_journal(file_), std::nullopt);
  EXPECT_FALSE(std::filesystem::exists(file_ + ".unfinished"));
}

TEST_F(DriveJournalTest, ThatCannotBeWrittenIsAFaultAndIsTriedAgainAMinuteLater) {
  std::filesystem::remove_all(folder_ / "state");
  std::ofstream(folder_ / "state") << "in the way";
  start_epoch(7, {});
  drive(3);
  while (journal_.fault().empty()) write();
  EXPECT_FALSE(journal_.wants_anew(utime_ + 10'000'000));
  EXPECT_TRUE(journal_.wants_anew(utime_ + 61'000'000));
  std::filesystem::remove(folder_ / "state");
  start_epoch(7, {});
  drive(10);
  settle();
  EXPECT_THAT(journal_.fault(), IsEmpty());
  EXPECT_THAT(read()->poses, Not(IsEmpty()));
}

}  // namespace
}  // namespace curbstone::mapper::journal
