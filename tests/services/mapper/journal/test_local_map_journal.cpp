#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "services/mapper/journal/local_map_file.hpp"
#include "services/mapper/journal/local_map_journal.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::journal {
namespace {

using registration::ShapeLevel;
using registration::ShapeLevelOptions;

class LocalMapJournalTest : public ::testing::Test {
 protected:
  /// Points in the n-th row of so many voxels.
  void insert(int row, int voxels) {
    for (ShapeLevel* level : levels_) {
      for (int i = 0; i < voxels; ++i)
        level->insert({0.1 + 0.3 * i, 0.1 + 0.3 * row, 0.1}, Eigen::Vector3f(10, 0, -1.7F).normalized());
      level->end_insertion();
    }
  }
  /// Until the file has it all.
  void write(LocalMapJournal& journal, std::int32_t epoch = 7) {
    now_ += 1'000'000;
    for (int i = 0; i < 200; ++i) {
      journal.write(levels_, epoch, now_, now_);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  [[nodiscard]] std::optional<RecordedLocalMap> read(std::int32_t epoch = 7) const {
    return read_local_map(path_, "settings", epoch);
  }
  /// The sums of a fine level that is made of what was read.
  static std::vector<std::array<float, 13>> sums_of(ShapeLevel& level) {
    level.note_changes();
    std::vector<std::array<float, 13>> sums;
    for (const registration::VoxelSums& voxel : level.take_changed(1'000'000)) sums.push_back(voxel.sums);
    std::sort(sums.begin(), sums.end());
    return sums;
  }

  test::TemporaryFolder folder_;
  std::string path_ = folder_ / "drive.journal.local_map";
  ShapeLevel fine_{ShapeLevelOptions{}}, coarse_{ShapeLevelOptions{.voxel = 1.0}};
  std::vector<ShapeLevel*> levels_{&fine_, &coarse_};
  std::int64_t now_ = 0;
};

TEST_F(LocalMapJournalTest, HasTheMapAsItGrew) {
  LocalMapJournal journal(path_, "settings");
  insert(0, 300);
  write(journal);
  for (int row = 0; row < 5; ++row) {
    insert(row, 200);
    write(journal);
  }
  const auto map = read();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->utime, now_);
  ASSERT_EQ(map->levels.size(), 2);
  ShapeLevel restored{ShapeLevelOptions{}};
  restored.restore(map->levels[0]);
  EXPECT_EQ(restored.size(), 300 + 4 * 200);
  EXPECT_EQ(sums_of(restored), sums_of(fine_));
}

TEST_F(LocalMapJournalTest, IsOfOneDriveAndEpochOnly) {
  LocalMapJournal journal(path_, "settings");
  insert(0, 10);
  write(journal);
  EXPECT_TRUE(read());
  EXPECT_FALSE(read(8));
  EXPECT_FALSE(read_local_map(path_, "others", 7));
  write(journal, 8);
  EXPECT_TRUE(read(8));
}

TEST_F(LocalMapJournalTest, IsContinuedByASuccessorAndByItsSuccessor) {
  insert(0, 2000);
  {
    LocalMapJournal journal(path_, "settings");
    write(journal);
  }
  const auto size = std::filesystem::file_size(path_);
  std::string batch(100, '\0');
  std::ifstream(path_, std::ios::binary).read(batch.data(), 100);
  std::ofstream(path_, std::ios::app | std::ios::binary) << batch;  // it was cut short
  for (std::int32_t epoch = 8; epoch < 10; ++epoch) {
    const auto map = read(epoch - 1);
    ASSERT_TRUE(map);
    fine_ = ShapeLevel{ShapeLevelOptions{}};
    coarse_ = ShapeLevel{ShapeLevelOptions{.voxel = 1.0}};
    fine_.restore(map->levels[0]);
    coarse_.restore(map->levels[1]);
    LocalMapJournal journal(path_, "settings");
    journal.adopt(*map);
    insert(epoch, 10);
    write(journal, epoch);
    EXPECT_EQ(fine_.size(), 2000 + 10 * (epoch - 7));
  }
  EXPECT_LT(std::filesystem::file_size(path_), size + 5000) << "what it had is not written again";
  EXPECT_EQ(read(9)->levels[0].size(), 2020);
}

TEST_F(LocalMapJournalTest, OfAnotherMapBeginsAnew) {
  LocalMapJournal journal(path_, "settings");
  insert(0, 300);
  write(journal);
  fine_ = ShapeLevel{ShapeLevelOptions{}};
  coarse_ = ShapeLevel{ShapeLevelOptions{.voxel = 1.0}};
  insert(0, 5);
  write(journal);
  EXPECT_EQ(read()->levels[0].size(), 5);
}

TEST_F(LocalMapJournalTest, StaysSmall) {
  LocalMapJournal journal(path_, "settings");
  for (int i = 0; i < 20; ++i) {
    insert(0, 20'000);
    write(journal);
    EXPECT_LT(std::filesystem::file_size(path_), 10'000'000);
  }
  EXPECT_EQ(read()->utime, now_);
  journal.remove();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(LocalMapJournalTest, ThatIsDamagedIsNone) {
  LocalMapJournal journal(path_, "settings");
  insert(0, 300);
  write(journal);
  {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(500);
    file.put('x');
  }
  EXPECT_FALSE(read());
}

}  // namespace
}  // namespace curbstone::mapper::journal
