#include "tools/output/new_file.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace curbstone::output
