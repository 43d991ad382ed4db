#include "procman/deputy/drive_mark.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone::procman::deputy {
namespace {

TEST(DriveMark, IsOfADriveThatWasBrokenOffAMomentAgo) {
  const testing::TemporaryFolder folder;
  const std::string file = folder / "drive.journal";
  EXPECT_FALSE(is_of_broken_off_drive(file)) << "the last drive came to its end";
  EXPECT_FALSE(is_of_broken_off_drive(""));
  std::ofstream(file) << "x";
  EXPECT_TRUE(is_of_broken_off_drive(file));
  for (const int hours : {-1, 1}) {
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() + std::chrono::hours(hours));
    EXPECT_FALSE(is_of_broken_off_drive(file)) << hours;
  }
}

}  // namespace
}  // namespace curbstone::procman::deputy
