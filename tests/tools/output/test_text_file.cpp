#include "tools/output/text_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "tests/temporary_folder.hpp"

namespace curbstone::output {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(TextFileTest, ReplacesAFileAndLeavesNothingBesideIt) {
  const test::TemporaryFolder folder;
  write_text(folder / "a.json", "a longer text");
  write_text(folder / "a.json", "short");
  EXPECT_EQ(content(folder / "a.json"), "short");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(TextFileTest, WhereNothingCanBeWrittenTheErrorNamesFileAndCause) {
  try {
    write_text("/nonexistent/a.json", "{}");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nonexistent/a.json: cannot be written: No such file or directory");
  }
}

TEST(TextFileTest, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(write_text("/dev/full", "{}"), std::runtime_error);
}

TEST(TextFileTest, APipeIsWrittenToAndStaysAPipe) {
  const test::TemporaryFolder folder;
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::jthread reader([&] { read = content(pipe); });
  write_text(pipe, "{}");
  reader.join();
  EXPECT_EQ(read, "{}");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

}  // namespace
}  // namespace curbstone::output
