#include "common/packing/spill_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/temporary_folder.hpp"
#include "tests/truncated_spill_files.hpp"

namespace curbstone {
namespace {

PackedValues values_of(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  PackedValues values(size);
  for (std::byte& value : values) value = static_cast<std::byte>(random());
  return values;
}

TEST(SpillFile, BringsBackWhatWasPutAwayInMemoryOrNot) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  std::vector<SpillFile::Values> away;
  for (unsigned i = 0; i < 50; ++i) {
    away.push_back(file.put(values_of(1 + 977 * i, i)));
    EXPECT_EQ(away[i / 2].read(), values_of(1 + 977 * (i / 2), i / 2));  // while some are written
  }
  file.flush();
  EXPECT_EQ(file.fault(), "");
  EXPECT_EQ(file.bytes_in_memory(), 0U);
  EXPECT_EQ(file.bytes_in_file(), 50U + 977U * 49 * 25);
  for (unsigned i = 0; i < 50; ++i) EXPECT_EQ(away[i].read(), values_of(1 + 977 * i, i));
}

TEST(SpillFile, HasNoName) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  (void)file.put(values_of(100, 1));
  file.flush();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SpillFile, ForgetsWhatNobodyHasAnyMore) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  std::optional<SpillFile::Values> one = file.put(values_of(5000, 1));
  std::optional<SpillFile::Values> copy = one;
  file.flush();
  one.reset();
  EXPECT_EQ(copy->read(), values_of(5000, 1));
  EXPECT_EQ(file.bytes_in_file(), 5000U);
  copy.reset();
  EXPECT_EQ(file.bytes_in_file(), 0U);
  for (int i = 0; i < 100; ++i) (void)file.put(values_of(5000, 2));  // nobody keeps them: some never are written
  file.flush();
  EXPECT_EQ(file.bytes_in_file() + file.bytes_in_memory(), 0U);
}

TEST(SpillFile, WithoutAFolderKeepsThemInMemory) {
  SpillFile file;
  const SpillFile::Values away = file.put(values_of(1000, 1));
  file.flush();
  EXPECT_EQ(away.read(), values_of(1000, 1));
  EXPECT_EQ(file.bytes_in_memory(), 1000U);
  EXPECT_EQ(file.fault(), "");
}

TEST(SpillFile, SaysThatItCannotWriteAndKeepsThemInMemory) {
  SpillFile file("/nowhere/at/all");
  const SpillFile::Values away = file.put(values_of(1000, 1));
  EXPECT_EQ(away.read(), values_of(1000, 1));
  EXPECT_THAT(file.fault(), testing::HasSubstr("/nowhere/at/all"));
}

TEST(SpillFile, LeavesTheLastOfTheDiskToOthers) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), std::numeric_limits<std::uint64_t>::max() / 2);
  std::optional<SpillFile::Values> away = file.put(values_of(1000, 1));
  file.flush();
  EXPECT_EQ(file.fault(), "the disk is nearly full");
  EXPECT_EQ(file.bytes_in_memory(), 1000U);
  EXPECT_EQ(away->read(), values_of(1000, 1));
  away.reset();
  for (int i = 0; i < 2000 && !file.fault().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(file.fault(), "") << "nothing is left to be written";
}

TEST(SpillFile, SaysThatItCannotRead) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  const SpillFile::Values away = file.put(values_of(1000, 1));
  file.flush();
  test::truncate_spill_files();
  EXPECT_EQ(file.failed_reads(), 0);
  EXPECT_THROW((void)away.read(), std::runtime_error);
  EXPECT_EQ(file.failed_reads(), 1);
}

TEST(SpillFile, ItsValuesMayOutliveIt) {
  const test::TemporaryFolder folder;
  SpillFile::Values written, waiting;
  {
    SpillFile file(folder.path().string(), 0);
    written = file.put(values_of(1000, 1));
    file.flush();
    waiting = file.put(values_of(1000, 2));
  }
  EXPECT_EQ(written.read(), values_of(1000, 1));
  EXPECT_EQ(waiting.read(), values_of(1000, 2));
  EXPECT_FALSE(written.empty());
  EXPECT_TRUE(SpillFile::Values().empty());
}

}  // namespace
}  // namespace curbstone
