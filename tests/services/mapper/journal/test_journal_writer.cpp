#include "services/mapper/journal/journal_writer.hpp"

#include <gmock/gmock.h>

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
  void write(const std::string& batch) {
    writer_.append(batch, true);
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

}  // namespace
}  // namespace curbstone::mapper::journal
