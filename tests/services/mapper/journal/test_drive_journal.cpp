#include "services/mapper/journal/drive_journal.hpp"

#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "tests/damaged_spill_files.hpp"
#include "tests/services/mapper/journal/drive_journal_test.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

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

TEST_F(DriveJournalTest, OfAMapThatStillMovesTakesNobodysPlace) {
  start_epoch(6, {});
  drive(10);
  for (int x = 0; x < 400; ++x) {
    std::vector<TilePoint> records;
    for (int i = 0; i < 2000; ++i)
      records.push_back({static_cast<std::int16_t>(25 * (i % 50)), static_cast<std::int16_t>(25 * (i / 50)), 0, 1});
    map_.restore({x, 5}, 0, {std::move(records), {{0, 0, kStart}}}, Eigen::Vector3d::Zero());
    changed_.push_back({x, 5});
  }
  settle();
  map_.move({});
  start_epoch(7, read()->poses);
  ASSERT_TRUE(map_.is_moving());
  for (int i = 0; i < 100; ++i) {
    write();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(read()->epoch, 6);
  EXPECT_GT(read()->tiles.size(), 400U) << "all that a successor needs";
  std::filesystem::last_write_time(file_, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  utime_ += 1'500'000;
  wait_until([this] { return *age_of_journal(file_) < 60; });
  EXPECT_EQ(read()->epoch, 6) << "and it is not too old for him";
  drive(20);
  ASSERT_FALSE(map_.is_moving());
  settle();
  EXPECT_EQ(read()->epoch, 7);
  expect_all(*read());
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
  EXPECT_FALSE(journal_.needs_restart(utime_ + 5'000'000)) << "there is no room yet";
  std::filesystem::remove(ballast);
  EXPECT_FALSE(journal_.needs_restart(utime_ + 1'000'000));
  EXPECT_TRUE(journal_.needs_restart(utime_ + 3'000'000));
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
  while (!journal_.needs_restart(utime_)) drive(100, 6);
  settle();
  const auto bytes = std::filesystem::file_size(file_);
  start_epoch(7, read()->poses);
  EXPECT_FALSE(journal_.needs_restart(utime_));
  drive(1, 6);
  wait_until([&] { return std::filesystem::file_size(file_) < bytes; });
  settle();
  EXPECT_LT(std::filesystem::file_size(file_), bytes / 2 + 200'000);
  expect_all(*read());
}

TEST_F(DriveJournalTest, IsReadIntoAFileAndNotIntoMemory) {
  start_epoch(7, {});
  drive(700, 6);
  settle();
  const std::optional<RecordedDrive> here = read();
  SpillFile far(folder_.path().string(), 0);
  std::optional<RecordedDrive> drive = read_journal(file_, kMaxBytes, "settings", &far);
  ASSERT_TRUE(here && drive);
  far.flush();
  ASSERT_EQ(drive->tiles.size(), here->tiles.size());
  for (auto& [key, tile] : drive->tiles) {
    EXPECT_TRUE(tile.content.records.empty());
    EXPECT_TRUE(tile.spilled.is_in_file());
    tile.content = tile.spilled.read();
    EXPECT_EQ(tile.content, here->tiles.at(key).content);
  }
  ASSERT_EQ(drive->nodes.size(), here->nodes.size());
  EXPECT_TRUE(drive->nodes.front().kept.points.is_in_file());
  expect_all(*drive);
}

TEST_F(DriveJournalTest, OfAMapperWithOtherSettingsIsRefused) {
  start_epoch(7, {});
  drive(10);
  settle();
  EXPECT_THROW((void)read_journal(file_, kMaxBytes, "other settings"), JournalError);
  EXPECT_THROW((void)read_journal(file_, 1000, "settings"), JournalError) << "larger than allowed";
}

TEST_F(DriveJournalTest, AdoptedIsKeptYoungUntilTheNextOneHasAsMuch) {
  start_epoch(7, {});
  drive(1500, 6);
  settle();
  const std::string other = folder_ / "copy.journal";
  std::filesystem::copy_file(file_, other);
  const auto make_old = [&] {
    std::filesystem::last_write_time(other, std::filesystem::file_time_type::clock::now() - std::chrono::seconds(15));
  };
  DriveJournal successor(other, kMaxBytes, "settings");
  successor.adopt(*read());
  make_old();
  const auto wait_until_young = [&](const std::function<void()>& step) {
    for (int i = 0; i < 2000 && *age_of_journal(other) > 5; ++i) {
      step();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return *age_of_journal(other) < 5;
  };
  EXPECT_TRUE(wait_until_young([&] { successor.wait(utime_); })) << "before the first scan";
  successor.start_epoch(8, read()->poses);
  make_old();
  successor.write(map_, atlas_, {}, {}, utime_);  // a part of it
  ASSERT_EQ(read_journal(other, kMaxBytes, "settings")->epoch, 7);
  EXPECT_TRUE(wait_until_young([] {})) << "while the next one is written beside it";
  EXPECT_EQ(read_journal(other, kMaxBytes, "settings")->epoch, 7);
}

TEST_F(DriveJournalTest, HasWhatTheDiskOfFarTilesReturnsLater) {
  config::DenseConfig config;
  config.asleep_here = 0;
  const auto far = std::make_shared<SpillFile>(folder_.path().string(), 0);
  map_ = dense_map::DenseMap(config, far);
  drive(700, 6);
  far->flush();
  test::flip_a_bit_of_each_spilled_page();
  start_epoch(7, {});
  revolve(6);
  changed_.clear();
  wait_until([this] { return age_of_journal(file_) && read() && !read()->poses.empty(); });
  EXPECT_LT(read()->tiles.size(), tiles().size()) << "what is in memory";
  EXPECT_GT(far->unreadable(), 0);
  test::flip_a_bit_of_each_spilled_page();
  utime_ += 2'000'000;
  settle();
  EXPECT_EQ(far->unreadable(), 0);
  EXPECT_EQ(far->read_fault(), "");
  EXPECT_EQ(read()->tiles.size(), tiles().size());
}

TEST_F(DriveJournalTest, ThatIsDeletedMeanwhileIsBegunAnew) {
  start_epoch(7, {});
  drive(20);
  settle();
  std::filesystem::remove_all(folder_ / "state");
  for (int i = 0; i < 3000 && journal_.fault().empty(); ++i) {
    drive(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_THAT(journal_.fault(), ::testing::HasSubstr("No such file"));
  EXPECT_TRUE(journal_.needs_restart(utime_ + 3'000'000));
  start_epoch(7, {});
  drive(5);
  settle();
  EXPECT_THAT(journal_.fault(), IsEmpty());
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
  EXPECT_FALSE(journal_.needs_restart(utime_ + 10'000'000));
  EXPECT_TRUE(journal_.needs_restart(utime_ + 61'000'000));
  std::filesystem::remove(folder_ / "state");
  start_epoch(7, {});
  drive(10);
  settle();
  EXPECT_THAT(journal_.fault(), IsEmpty());
  EXPECT_THAT(read()->poses, Not(IsEmpty()));
}

}  // namespace
}  // namespace curbstone::mapper::journal
