#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "tests/services/mapper/journal/drive_journal_test.hpp"
#include "tests/services/mapper/journal/killed_mapper.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A mapper that is killed again and again, each time without notice.
class KilledAgainTest : public KilledMapperTest {
 protected:
  /// In real time: between two revolutions the driver and the filter send again for two and a half ticks.
  void go_on(int turns) {
    is_new_ = false;
    for (int i = 0; i < turns; ++i) {
      step();
      send_again(3);
    }
  }
  /// Of the revolutions that were driven, those that have no pose.
  [[nodiscard]] std::set<int> without_pose() const {
    std::set<int> missing;
    for (int n = poses_.front().revolution; n < poses_.back().revolution; ++n) missing.insert(n);
    for (const map_pose_t& pose : poses_) missing.erase(pose.revolution);
    return missing;
  }
};

TEST_F(KilledAgainTest, LosesNothingHoweverOftenIfEachComesToMapSomething) {
  world_.noise = 0.005;
  start_mapper();
  drive(160);
  kill_mapper();
  const std::filesystem::path first = folder_ / "first";
  std::filesystem::create_hard_link(config_.journal, first);
  for (int kill = 0; kill < 12; ++kill) {
    go_on(2);
    start_mapper();
    go_on(1);
    EXPECT_FALSE(std::filesystem::exists(config_.journal + ".unfinished")) << "it need not write the whole map first";
    go_on(27);  // 1.4 s in all
    EXPECT_TRUE(std::filesystem::equivalent(config_.journal, first)) << "nor later";
    kill_mapper_at_once();
  }
  start_mapper();
  drive(10);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_THAT(without_pose(), IsEmpty());
  EXPECT_EQ(pages_.back().utimes.front(), poses_.front().utime) << "the drive since its beginning";
  EXPECT_LT(error(), 0.15);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(KilledAgainTest, SaysHowMuchOfTheDriveIsMissingWhereNobodySendsItAgain) {
  start_mapper();
  drive(60);
  kill_mapper();
  drive(30);
  start_driver();
  start_mapper();
  drive(20);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_EQ(counter("resumed.missing_ms"), 2750) << "1.25 s that had not settled, and 1.5 s";
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("2.8 s of the drive are missing")));
}

TEST_F(DriveJournalTest, IsContinuedInItsFile) {
  start_epoch(6, {});
  drive(60, 6);
  settle();
  const std::string other = folder_ / "copy.journal";
  std::filesystem::copy_file(file_, other);
  std::ofstream(other, std::ios::app | std::ios::binary) << "CJL1, and then it died";
  const auto bytes = std::filesystem::file_size(file_);
  const auto in_other = [&] { return *read_journal(other, kMaxBytes, "settings"); };
  const RecordedDrive before = in_other();
  const std::int64_t until = before.poses[before.poses.size() - 3].utime;

  DriveJournal successor(other, kMaxBytes, "settings");
  successor.adopt(before);
  ASSERT_TRUE(successor.continue_epoch(7, until, map_, atlas_));
  for (int i = 0; i < 2000 && in_other().epoch != 7; ++i) {
    successor.write(map_, atlas_, {}, {}, utime_ += 1'000'000);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const RecordedDrive after = in_other();
  ASSERT_EQ(after.epoch, 7);
  EXPECT_EQ(after.poses.back().utime, until);
  EXPECT_EQ(after.tiles.size(), before.tiles.size());
  EXPECT_LT(std::filesystem::file_size(other), bytes + 1000) << "nothing is written twice";
  EXPECT_FALSE(std::filesystem::exists(other + ".unfinished"));
  EXPECT_EQ(successor.fault(), "");
}

TEST_F(DriveJournalTest, IsNotContinuedWhereTheMapIsAnother) {
  start_epoch(6, {});
  drive(60, 6);
  settle();
  const std::string other = folder_ / "copy.journal";
  std::filesystem::copy_file(file_, other);
  DriveJournal successor(other, kMaxBytes, "settings");
  successor.adopt(*read());
  const dense_map::DenseMap empty{config::DenseConfig{}};
  EXPECT_FALSE(successor.continue_epoch(7, utime_, empty, atlas_)) << "tiles that could not be read";
}

}  // namespace
}  // namespace curbstone::mapper::journal
