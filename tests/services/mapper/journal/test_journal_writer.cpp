#include "services/mapper/journal/journal_writer.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class JournalWriterTest : public ::testing::Test {
 protected:
  void write(const std::string& batch, bool is_complete = true) {
    writer_.append(batch, is_complete);
    while (writer_.busy()) std::this_thread::yield();
  }
  test::TemporaryFolder folder_;
  const std::string file_ = folder_ / "drive.journal";
  JournalWriter writer_{file_, 1'000'000};
};

TEST_F(JournalWriterTest, KnowsAFullDiskByItsErrorAndNotByTheText) {
  std::filesystem::create_symlink("/dev/full", file_ + ".unfinished");
  writer_.begin();
  write("a batch");
  EXPECT_EQ(writer_.error(), std::errc::no_space_on_device);
  EXPECT_THAT(writer_.fault(), HasSubstr(file_));
  EXPECT_TRUE(writer_.has_room_again()) << "beside it, where there is room";
  EXPECT_FALSE(std::filesystem::exists(file_));
  writer_.begin();
  EXPECT_FALSE(writer_.error());
  EXPECT_FALSE(writer_.has_room_again()) << "it was not full";
  write("a batch");
  EXPECT_THAT(writer_.fault(), IsEmpty());
  EXPECT_EQ(std::filesystem::file_size(file_), 7U);
}

TEST_F(JournalWriterTest, DoesNotTakeAnotherErrorForAFullDisk) {
  std::filesystem::create_directory(file_ + ".unfinished");
  writer_.begin();
  write("a batch");
  EXPECT_EQ(writer_.error(), std::errc::is_a_directory);
  EXPECT_FALSE(writer_.has_room_again());
}

TEST_F(JournalWriterTest, HasNoErrorOfTheSystemWhereTheJournalIsFull) {
  writer_.begin();
  write(std::string(1'000'001, 'x'));
  EXPECT_TRUE(writer_.is_full());
  EXPECT_FALSE(writer_.error());
  EXPECT_FALSE(writer_.has_room_again());
}

TEST_F(JournalWriterTest, KeepsItsOwnFileYoungWhileAnotherIsBegunAndNobodyElses) {
  const auto age = [&] {
    return std::filesystem::file_time_type::clock::now() - std::filesystem::last_write_time(file_);
  };
  const auto make_old = [&] {
    std::filesystem::last_write_time(file_, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  };
  std::ofstream(file_) << "of a drive of yesterday";
  make_old();
  writer_.begin();
  write("a part", false);
  EXPECT_GT(age(), std::chrono::minutes(59));
  write("the rest");
  EXPECT_LT(age(), std::chrono::minutes(1));
  make_old();
  writer_.begin();
  write("a part of the next", false);
  EXPECT_LT(age(), std::chrono::minutes(1));
  EXPECT_EQ(std::filesystem::file_size(file_), 14U) << "it is still the one before";
}

}  // namespace
}  // namespace curbstone::mapper::journal
