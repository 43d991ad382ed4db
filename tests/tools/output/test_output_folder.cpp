#include "tools/output/output_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "tests/temporary_folder.hpp"

namespace curbstone::output {
namespace {

class OutputFolderTest : public ::testing::Test {
 protected:
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) names.insert(entry.path().filename());
    return names;
  }
  test::TemporaryFolder folder_;
};

TEST_F(OutputFolderTest, FilesGetTheirNamesTogetherInTheOrderOfAdding) {
  OutputFolder out(folder_.path());
  out.add_bytes("b.txt", "b");
  out.add("a.txt", [](const std::string& path) { std::ofstream(path) << "a"; });
  EXPECT_FALSE(names().contains("b.txt"));
  EXPECT_EQ(out.commit(), (std::vector<std::string>{"b.txt", "a.txt"}));
  EXPECT_EQ(names(), (std::set<std::string>{"a.txt", "b.txt"}));
}

TEST_F(OutputFolderTest, IfOneFileFailsNoneIsThere) {
  {
    OutputFolder out(folder_.path());
    out.add_bytes("a.txt", "a");
    EXPECT_THROW(out.add("b.txt", [](const std::string&) { throw std::runtime_error("no"); }), std::runtime_error);
  }
  EXPECT_TRUE(names().empty());
}

TEST_F(OutputFolderTest, OfAFailureNoFolderIsLeft) {
  std::filesystem::create_directory(folder_ / "there");
  { OutputFolder out(folder_ / "there"); }
  {
    OutputFolder out(folder_ / "there/a/b");
    EXPECT_THROW(out.add("c.txt", [](const std::string&) { throw std::runtime_error("no"); }), std::runtime_error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "there"));
  {
    OutputFolder out(folder_ / "there/a/b");
    out.add_bytes("c.txt", "c");
    out.commit();
  }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "there/a/b/c.txt"));
}

TEST_F(OutputFolderTest, AFileOfAnEarlierExportThatWouldMisleadGoes) {
  std::ofstream(folder_ / "map.prj") << "old";
  OutputFolder out(folder_.path());
  out.add_bytes("map.txt", "new");
  out.leave_out("map.prj");
  out.commit();
  EXPECT_EQ(names(), std::set<std::string>{"map.txt"});
}

TEST_F(OutputFolderTest, AFolderThatCannotBeMadeIsAnErrorThatNamesIt) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(OutputFolder((folder_ / "file" / "below").string()), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::output
