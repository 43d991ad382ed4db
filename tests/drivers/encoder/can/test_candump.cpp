#include "drivers/encoder/can/candump.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

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
  for (const char* line : {"",
                           "   *** EAGLE-TRT",
                           "(1608055974.318981)",
                           "(1608055974.318981) can0",
                           "(1608055974) can0 202#90",
                           "(1608055974.1234567890) can0 202#90",
                           "(-1.000000) can0 202#90",
                           "(1.000000) can0 802#90",
                           "(1.000000) can0 202#9",
                           "(1.000000) can0 202#9G",
                           "(1.000000) can0 202#112233445566778899",
                           "(1.000000) can0 802##1AABB",
                           "(1.000000) can0 202##1AAB",
                           "(1.000000) can0 202##",
                           "1.000000 can0 202#90",
                           "(1.000000) can0 202#1122334455667788_8",
                           "(1.000000) can0 202#11223344556677_9",
                           "(1.000000) can0 202#1122334455667788_G",
                           "(1.000000) can0 202#90 nonsense",
                           "(1.000000) can0 202#R9"}) {
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

TEST(CandumpTest, TimesOfOtherWidthsAreReadToTheMicrosecond) {
  for (const auto& [text, utime] : std::vector<std::pair<const char*, std::int64_t>>{
           {"(3.5) can0 202#90", 3'500'000},
           {"(1759190400.123456789) can0 202#90", 1'759'190'400'123'456},
           {"(000.001103) can0 202#90", 1'103},
           {"(1234.567) can0 202#90", 1'234'567'000},
           {"(2023-12-31 23:59:58.000250) can0 202#90", 1'704'067'198'000'250},
           {"(2024-02-29 00:00:01.5) can0 202#90", 1'709'164'801'500'000}}) {
    const auto line = parse_candump_line(text);
    ASSERT_TRUE(line) << text;
    EXPECT_EQ(line->utime, utime) << text;
    EXPECT_EQ(line->frame, CanFrame::make(0x202, {0x90}));
  }
  for (const char* text : {"(2023-02-29 00:00:01.5) can0 202#90", "(2023-13-01 00:00:01.5) can0 202#90",
                           "(2023-12-01 24:00:01.5) can0 202#90", "(2023-12-01T20:00:01.5) can0 202#90",
                           "(12345678901234.5) can0 202#90", "(1.5 can0 202#90", "(1.5)can0 202#90"}) {
    EXPECT_FALSE(parse_candump_line(text)) << text;
  }
}

/// Many record what candump shows, with candump -ta can0 > file.
TEST(CandumpTest, WhatCandumpShowsIsReadAsWhatItLogs) {
  const CanFrame frame = CanFrame::make(0x1A5, {0x0B, 0xC0, 0x00, 0xFE});
  for (const char* text :
       {" (1608055974.318981)  can0  1A5   [4]  0B C0 00 FE", "(1608055974.318981) can0 1A5 [4] 0B C0 00 FE\r",
        " (2020-12-15 18:12:54.318981)  can0  1A5   [4]  0B C0 00 FE",
        " (1608055974.318981)  can0       1A5   [4]  0b c0 00 fe   '....'",
        " (1608055974.318981)\tcan0\tRX - -  1A5   [4]  0B C0 00 FE ",
        " (1608055974.318981)  can0  TX B E  1A5   [4]  0B C0 00 FE   '. ('"}) {
    const auto line = parse_candump_line(text);
    ASSERT_TRUE(line) << text;
    EXPECT_EQ(line->utime, 1'608'055'974'318'981) << text;
    EXPECT_EQ(line->interface, "can0");
    EXPECT_EQ(line->frame, frame) << text;
    EXPECT_FALSE(line->other);
  }
  ASSERT_TRUE(parse_candump_line("\r(1608055974.318981) can0 1A5#0BC000FE")) << "a logger that writes LF CR";
  const auto extended = parse_candump_line(" (000.100000)  vcan0  0CFE6CEE   [0] ");
  ASSERT_TRUE(extended);
  EXPECT_TRUE(extended->frame.extended);
  EXPECT_EQ(extended->frame.id, 0xCFE6CEEu);
  EXPECT_EQ(extended->frame.size, 0);
  EXPECT_TRUE(parse_candump_line("(1.5)  can0  CFE6CEE   [1]  00")->frame.extended)
      << "older versions fill with blanks";
  const auto remote = parse_candump_line(" (1.000000)  can0  701   [1]  remote request");
  ASSERT_TRUE(remote);
  EXPECT_TRUE(remote->frame.remote);
  EXPECT_EQ(remote->frame.size, 1);
  EXPECT_EQ(parse_candump_line("(1.5)  can0  202   {E}  11 22 33 44 55 66 77 88")->frame.size, 8);
  for (const char* text :
       {"(1.5)  can0  202  [12]  11 22 33 44 55 66 77 88 99 AA BB CC", "(1.5)  can0  202  [04]  11 22 33 44",
        "(1.5)  can0  20000088   [8]  00 00 08 00 00 00 00 00   ERRORFRAME"}) {
    const auto line = parse_candump_line(text);
    ASSERT_TRUE(line) << text;
    EXPECT_TRUE(line->other) << text;
  }
}

TEST(CandumpTest, WhatCandumpShowsIsRefusedIfItIsDamaged) {
  for (const char* text :
       {"(1.5)  can0  202   [2]  11", "(1.5)  can0  202   [2]  11 22 33", "(1.5)  can0  802   [1]  11",
        "(1.5)  can0  202   [9]  11 22 33 44 55 66 77 88 99", "(1.5)  can0  202   [-1]", "(1.5)  can0  202   (1)  11",
        "(1.5)  can0  202   [1]  1G", "(1.5)  can0  202   [1]  111", "(1.5)  can0  202", "(1.5)  can0  2   [1]  11",
        "(1.5)  can0  TX -  202   [1]  11", "(1.5)  can0  3FFFFFFFF   [1]  11",
        "(1.5)  can0  202   [2]  22`11",        // -S: the bytes swapped
        "(1.5)  can0  202   [1]  00010001"}) {  // -i: as bits
    EXPECT_FALSE(parse_candump_line(text)) << text;
  }
}

TEST(CandumpTest, LinesWithoutATimeAreTold) {
  EXPECT_TRUE(is_candump_without_time("  can0  202   [2]  11 22"));
  EXPECT_TRUE(is_candump_without_time("vcan0  RX - -  12345678   [0]  remote request\r"));
  for (const char* text :
       {"", "can0", "can0 202", "(1.5)  can0  202   [2]  11 22", "can0 202#1122", "Dear Sir, [1] 22"})
    EXPECT_FALSE(is_candump_without_time(text)) << text;
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
  for (int i = 0; i < 40'000; ++i) {
    const std::string good = i % 2 == 0
                                 ? "(1608055974.318981) can0 202#903C000000000000"
                                 : " (2020-12-15 18:12:54.3)  can0  TX - -  202   [8]  90 3C 00 00 00 00 00 00  '.'";
    std::string line = good.substr(0, random() % (good.size() + 1));
    for (unsigned k = random() % 4; k > 0 && !line.empty(); --k)
      line[random() % line.size()] = static_cast<char>(random());
    const auto parsed = parse_candump_line(line);
    EXPECT_TRUE(!parsed || parsed->frame.size <= 8);
  }
}

}  // namespace
}  // namespace curbstone::encoder::can
