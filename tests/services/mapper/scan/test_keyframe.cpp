#include "services/mapper/scan/keyframe.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/damaged_spill_files.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::scan {
namespace {

std::vector<KeyframePoint> scan_points() {
  std::vector<KeyframePoint> points{{-32768, 32767, 0}, {32767, -32768, -1}};
  for (int i = 0; i < 3000; ++i)
    points.push_back(
        {static_cast<std::int16_t>(7 * i), static_cast<std::int16_t>(-5 * i), static_cast<std::int16_t>(i)});
  return points;
}

TEST(KeyframePoints, AreTheSameWhileTheyAreAway) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  KeyframePoints points = scan_points();
  const KeyframePoints copy = points;
  points.spill(file);
  points.spill(file);
  file.flush();
  EXPECT_TRUE(points.is_spilled());
  EXPECT_FALSE(copy.is_spilled());
  EXPECT_EQ(points.size(), 3002U);
  EXPECT_FALSE(points.empty());
  EXPECT_EQ(*points.read(), scan_points());
  EXPECT_EQ(points, copy);
  EXPECT_FALSE(points.in_memory().is_spilled());
  EXPECT_EQ(points.in_memory(), copy);
  const std::size_t once = file.bytes_in_file();
  EXPECT_GT(once, 0U);
  points = {};
  EXPECT_TRUE(points.empty());
  EXPECT_TRUE(points.read()->empty());
  EXPECT_EQ(file.bytes_in_file(), 0U);
}

TEST(KeyframePoints, ThatTheDiskDoesNotReturnAreNone) {
  const test::TemporaryFolder folder;
  SpillFile file(folder.path().string(), 0);
  KeyframePoints points = scan_points();
  points.spill(file);
  file.flush();
  test::truncate_spill_files();
  EXPECT_TRUE(points.read()->empty());
  EXPECT_TRUE(points.in_memory().empty());
  EXPECT_EQ(points.size(), 3002U) << "what it should have";
  EXPECT_EQ(file.failed_reads(), 2);
}

TEST(KeyframePoints, OfNothingAreNotPutAway) {
  SpillFile file;
  KeyframePoints points;
  points.spill(file);
  EXPECT_FALSE(points.is_spilled());
  EXPECT_EQ(file.bytes_in_memory(), 0U);
}

}  // namespace
}  // namespace curbstone::mapper::scan
