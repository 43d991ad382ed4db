#include "drivers/encoder/can/candump.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "tests/drivers/byte_stream.hpp"
#include "tests/paths.hpp"

namespace curbstone::encoder::can {
namespace {

TEST(CandumpTest, ReadsALineOfARealLog) {
  const auto line = parse_candump_line("(1608055974.318981) can0 202#903C000000000000");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->utime, 1'608'055'974'318'981);
  EXPECT_EQ(line->interface, "can0");
  EXPECT_EQ(line->frame, CanFrame::make(0x202, {0x90, 0x3C, 0, 0, 0, 0, 0, 0}));
}

TEST(CandumpTest, ReadsExtendedRemoteAndEmptyFrames) {
  const auto extended = parse_candump_line("(1.000000) vcan0 0000012A#11\r");
  ASSERT_TRUE(extended);
  EXPECT_TRUE(extended->frame.extended);
  EXPECT_EQ(extended->frame.id, 0x12Au);
  const auto remote = parse_candump_line("(1.000000) can0 70A#R1");
  ASSERT_TRUE(remote);
  EXPECT_TRUE(remote->frame.remote);
  EXPECT_EQ(remote->frame.size, 1);
  const auto empty = parse_candump_line("(1.000000) can0 080# T");
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->frame.size, 0);
}

TEST(CandumpTest, WhatIsNoFrameIsReported) {
  for (const char* line :
       {"", "   *** EAGLE-TRT", "(1608055974.318981)", "(1608055974.318981) can0", "(1608055974.31898) can0 202#90",
        "(-1.000000) can0 202#90", "(1.000000) can0 802#90", "(1.000000) can0 202#9", "(1.000000) can0 202#9G",
        "(1.000000) can0 202#112233445566778899", "(1.000000) can0 802##1AABB", "(1.000000) can0 202##1AAB",
        "(1.000000) can0 202##", "1.000000 can0 202#90", "(1.000000) can0 202#1122334455667788_8",
        "(1.000000) can0 202#11223344556677_9", "(1.000000) can0 202#1122334455667788_G",
        "(1.000000) can0 202#90 nonsense", "(1.000000) can0 202#R9"}) {
    EXPECT_FALSE(parse_candump_line(line)) << line;
  }
}

TEST(CandumpTest, FramesThatAreNotClassicalAreNoDamage) {
  for (const char* text : {"(1.000000) can0 202##1AABB", "(1.000000) can0 0000012A##0", "(1.000000) can0 20000088#00",
                           "(1.000000) can0 20000004#0004000000000000"}) {
    const auto line = parse_candump_line(text);
    ASSERT_TRUE(line) << text;
    EXPECT_TRUE(line->other) << text;
  }
}

/// candump -8: a length code above 8 of a frame of 8 bytes.
TEST(CandumpTest, ALengthCodeAboveEightIsEightBytes) {
  const auto data = parse_candump_line("(1.000000) can0 202#1122334455667788_E R");
  ASSERT_TRUE(data);
  EXPECT_EQ(data->frame, CanFrame::make(0x202, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}));
  const auto remote = parse_candump_line("(1.000000) can0 202#R8_F");
  ASSERT_TRUE(remote);
  EXPECT_TRUE(remote->frame.remote);
  EXPECT_EQ(remote->frame.size, 8);
}

TEST(CandumpTest, AWholeRaceIsReadAndOnlyItsHeadingIsRefused) {
  const std::string file = test::data_path("can/fsae_candump.log");
  std::ifstream log(file);
  if (!log) GTEST_SKIP() << file << " is not there";
  int frames = 0;
  int refused = 0;
  std::int64_t first = 0;
  std::int64_t last = 0;
  std::set<std::uint32_t> ids;
  for (std::string text; std::getline(log, text);) {
    const auto line = parse_candump_line(text);
    if (!line) {
      ++refused;
      continue;
    }
    if (frames++ == 0) first = line->utime;
    EXPECT_GE(line->utime, last);
    last = line->utime;
    ids.insert(line->frame.id);
  }
  EXPECT_EQ(frames, 82'661);
  EXPECT_EQ(ids.size(), 14u);
  EXPECT_NEAR(static_cast<double>(last - first) * 1e-6, 39.9, 0.05);
  EXPECT_LT(refused, 12);
}

TEST(CandumpTest, BrokenLinesNeverReadBeyondTheirEnd) {
  std::mt19937 random(3);
  const std::string good = "(1608055974.318981) can0 202#903C000000000000";
  for (int i = 0; i < 20'000; ++i) {
    std::string line = good.substr(0, random() % (good.size() + 1));
    for (unsigned k = random() % 4; k > 0 && !line.empty(); --k)
      line[random() % line.size()] = static_cast<char>(random());
    const auto parsed = parse_candump_line(line);
    EXPECT_TRUE(!parsed || parsed->frame.size <= 8);
  }
}

}  // namespace
}  // namespace curbstone::encoder::can
