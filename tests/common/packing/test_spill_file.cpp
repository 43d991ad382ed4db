#include "common/packing/spill_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/damaged_spill_files.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

/// Long enough for a test to look at a fault before it passes.
constexpr std::chrono::seconds kRetry{1};

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

/// Whether nothing waits in memory any more.
bool is_on_the_disk_soon(const SpillFile& file) {
  for (int i = 0; i < 3000 && file.bytes_in_memory() > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return file.bytes_in_memory() == 0;
}

TEST(SpillFile, TakesAFolderThatAppearsLater) {
  const test::TemporaryFolder folder;
  const std::string later = folder / "disk";
  SpillFile file(later, 0, kRetry);
  const SpillFile::Values away = file.put(values_of(1000, 1));
  file.flush();
  EXPECT_THAT(file.fault(), testing::HasSubstr("No such file"));
  EXPECT_FALSE(file.takes());
  std::filesystem::create_directory(later);
  EXPECT_TRUE(is_on_the_disk_soon(file));
  EXPECT_EQ(file.fault(), "");
  EXPECT_TRUE(file.takes());
  EXPECT_TRUE(away.is_in_file());
  EXPECT_EQ(away.read(), values_of(1000, 1));
}

TEST(SpillFile, IsInAFaultWithoutItsFolderThoughNothingWaits) {
  SpillFile file("/nowhere/at/all");
  (void)file.put(values_of(1000, 1));
  file.flush();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_THAT(file.fault(), testing::HasSubstr("/nowhere/at/all"));
  EXPECT_FALSE(file.takes());
}

TEST(SpillFile, BeginsAnotherFileAfterTheDiskOfTheFirstIsGone) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0, kRetry);
  const SpillFile::Values before = file.put(values_of(1000, 1));
  file.flush();
  test::make_spill_files_fail();
  const SpillFile::Values after = file.put(values_of(1000, 2));
  file.flush();
  EXPECT_THAT(file.fault(), testing::HasSubstr(folder.path().string()));
  EXPECT_FALSE(file.takes());
  EXPECT_EQ(after.read(), values_of(1000, 2));
  EXPECT_TRUE(is_on_the_disk_soon(file));
  EXPECT_EQ(file.fault(), "");
  EXPECT_EQ(after.read(), values_of(1000, 2));
  EXPECT_THROW((void)before.read(), std::runtime_error) << "the disk has it no more";
}

TEST(SpillFile, LeavesTheLastOfTheDiskToOthers) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), std::numeric_limits<std::uint64_t>::max() / 2, kRetry);
  std::optional<SpillFile::Values> away = file.put(values_of(1000, 1));
  file.flush();
  EXPECT_EQ(file.fault(), "the disk is nearly full");
  EXPECT_EQ(file.bytes_in_memory(), 1000U);
  EXPECT_EQ(away->read(), values_of(1000, 1));
  away.reset();
  for (int i = 0; i < 2000 && !file.fault().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(file.fault(), "") << "nothing is left to be written";
}

/// A disk of 1 MB. False if there is no right to mount one.
bool mount_small_disk(const std::string& folder, unsigned long flags = 0) {
  return unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", flags, "size=1m") == 0;
}

TEST(SpillFile, OnADiskThatFillsUpKeepsTheRestInMemoryUntilThereIsRoomAgain) {
  const test::TemporaryFolder folder;
  const std::string disk = folder.path().string();
  if (!mount_small_disk(disk)) GTEST_SKIP() << "no right to mount a small disk";
  {
    SpillFile file(disk, 0, kRetry);
    std::vector<SpillFile::Values> away;
    for (unsigned i = 0; i < 40; ++i) away.push_back(file.put(values_of(50'000, i)));
    file.flush();
    EXPECT_NE(file.fault(), "");
    EXPECT_GT(file.bytes_in_file(), 800'000U);
    EXPECT_GT(file.bytes_in_memory(), 900'000U);
    for (unsigned i = 0; i < 40; ++i) EXPECT_EQ(away[i].read(), values_of(50'000, i)) << i;
    away.erase(away.begin(), away.begin() + 30);
    for (int i = 0; i < 2000 && file.bytes_in_memory() > 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(file.fault(), "");
    EXPECT_EQ(file.bytes_in_file(), 500'000U);
    for (unsigned i = 0; i < 10; ++i) EXPECT_EQ(away[i].read(), values_of(50'000, 30 + i)) << i;
    EXPECT_EQ(file.failed_reads(), 0);
  }
  umount2(disk.c_str(), MNT_DETACH);
}

TEST(SpillFile, GivesTheDiskBackWhatIsFreeAtItsEnd) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  std::vector<SpillFile::Values> away;
  for (unsigned i = 0; i < 100; ++i) away.push_back(file.put(values_of(50'000, i)));
  file.flush();
  const auto size = [] {
    off_t bytes = 0;
    test::for_each_spill_file([&](int descriptor) { bytes = ::lseek(descriptor, 0, SEEK_END); });
    return bytes;
  };
  EXPECT_GT(size(), 5'000'000);
  away.erase(away.begin() + 10, away.end());
  for (int i = 0; i < 2000 && size() > 1'000'000; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_LT(size(), 1'000'000);
  away.push_back(file.put(values_of(2'000'000, 200)));
  file.flush();
  for (unsigned i = 0; i < 10; ++i) EXPECT_EQ(away[i].read(), values_of(50'000, i)) << i;
  EXPECT_EQ(away.back().read(), values_of(2'000'000, 200));
}

TEST(SpillFile, OnADiskThatMayOnlyBeReadIsAFault) {
  const test::TemporaryFolder folder;
  if (!mount_small_disk(folder.path().string(), MS_RDONLY)) GTEST_SKIP() << "no right to mount a small disk";
  {
    SpillFile file(folder.path().string(), 0);
    const SpillFile::Values away = file.put(values_of(1000, 1));
    file.flush();
    EXPECT_THAT(file.fault(), testing::HasSubstr("Read-only file system"));
    EXPECT_EQ(away.read(), values_of(1000, 1));
  }
  umount2(folder.path().c_str(), MNT_DETACH);
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

TEST(SpillFile, ReturnsNothingThatIsNotWhatWasPutAway) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  const SpillFile::Values away = file.put(values_of(1000, 1)), large = file.put(values_of(100'000, 2));
  file.flush();
  EXPECT_EQ(file.read_fault(), "");
  test::flip_a_bit_of_each_spilled_page();
  EXPECT_THROW((void)away.read(), std::runtime_error);
  EXPECT_THROW((void)large.read(), std::runtime_error);
  EXPECT_EQ(file.failed_reads(), 2);
  EXPECT_EQ(file.read_fault(), folder.path().string() + ": a checksum is wrong");
  test::flip_a_bit_of_each_spilled_page();
  EXPECT_EQ(large.read(), values_of(100'000, 2)) << "the disk has come to its senses";
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
