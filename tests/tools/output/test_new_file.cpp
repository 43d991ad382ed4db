#include "tools/output/new_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/temporary_folder.hpp"

namespace curbstone::output {
namespace {

TEST(NewFileTest, HasItsNameOnlyWhenItIsWhole) {
  const test::TemporaryFolder folder;
  NewFile file(folder / "a.csv", false);
  std::ofstream(file.part()) << "x";
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
  file.commit();
  EXPECT_TRUE(std::filesystem::exists(folder / "a.csv"));
  EXPECT_FALSE(std::filesystem::exists(file.part()));
}

TEST(NewFileTest, LeavesNothingOfAWorkThatWasGivenUp) {
  const test::TemporaryFolder folder;
  {
    const NewFile file(folder / "a.csv", false);
    std::ofstream(file.part()) << "x";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(NewFileTest, ReplacesAFileOnlyByForce) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.csv") << "old";
  EXPECT_THROW(NewFile(folder / "a.csv", false), std::runtime_error);
  EXPECT_NO_THROW(NewFile(folder / "a.csv", true));
  EXPECT_TRUE(std::filesystem::exists(folder / "a.csv"));
}

/// As root `--out /dev/null --force` put a file in the device's place, for the whole machine.
TEST(NewFileTest, LeavesWhatIsNoRegularFileInItsPlace) {
  const test::TemporaryFolder folder;
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const bool force : {false, true}) {
    NewFile file(pipe, force);
    EXPECT_EQ(file.part(), pipe);
    file.commit();
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_THROW(NewFile(folder.path(), true), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::output
