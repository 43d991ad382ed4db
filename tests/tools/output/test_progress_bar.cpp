#include "tools/output/progress_bar.hpp"

#include <gtest/gtest.h>

namespace curbstone::output {
namespace {

TEST(ProgressLineTest, SaysHowMuchIsDoneAndHowLongTheRestTakes) {
  EXPECT_EQ(progress_line("replay", 0.4, 8, "12.3 s of drive"),
            "replay [############..................]  40 %  0:12 left  12.3 s of drive");
  EXPECT_EQ(progress_line("export", 1, 75, ""), "export [##############################] 100 %  0:00 left");
}

TEST(ProgressLineTest, TheFirstMomentsSayNothingOfTheRest) {
  EXPECT_EQ(progress_line("replay", 0, 5, ""), "replay [..............................]   0 %");
  EXPECT_EQ(progress_line("replay", 0.5, 0.5, ""), "replay [###############...............]  50 %");
}

TEST(ProgressLineTest, AFractionBeyondItsBoundsIsAtThem) {
  EXPECT_EQ(progress_line("replay", 1.5, 0, ""), progress_line("replay", 1, 0, ""));
  EXPECT_EQ(progress_line("replay", -1, 0, ""), progress_line("replay", 0, 0, ""));
}

}  // namespace
}  // namespace curbstone::output
