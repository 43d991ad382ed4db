#include "drivers/encoder/traces/pcan_trace.hpp"

#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace curbstone::encoder::traces {
namespace {

using Kind = PcanTrace::Line::Kind;

constexpr std::int64_t kStart = 1'649'163'686'039'000;  // 2022-04-05 13:01:26.039

TEST(PcanTraceTest, ReadsAFileOfVersion11) {
  PcanTrace trace;
  EXPECT_EQ(trace.parse(";$FILEVERSION=1.1\r").kind, Kind::kComment);
  EXPECT_EQ(trace.parse(";$STARTTIME=44656.5426624884").kind, Kind::kComment);
  EXPECT_EQ(trace.parse(";   |         Time Offset (ms)").kind, Kind::kComment);
  const auto line = trace.parse("     2)        72.1  Rx         010A  8  AB 02 22 0E 99 8C 00 00 \r");
  ASSERT_EQ(line.kind, Kind::kFrame);
  EXPECT_EQ(line.frame, can::CanFrame::make(0x10A, {0xAB, 0x02, 0x22, 0x0E, 0x99, 0x8C, 0, 0}));
  EXPECT_NEAR(static_cast<double>(line.utime - kStart), 72'100, 1'000);
  const auto extended = trace.parse("     3)     1284.0  Tx     0000012A  1  11");
  ASSERT_EQ(extended.kind, Kind::kFrame);
  EXPECT_TRUE(extended.frame.extended);
  const auto remote = trace.parse("     4)     7468.9  Tx         0000  8  RTR");
  ASSERT_EQ(remote.kind, Kind::kFrame);
  EXPECT_TRUE(remote.frame.remote);
  EXPECT_EQ(trace.parse("     5)     7469.0  Warng  FFFFFFFF  4  00 00 00 08  BUSHEAVY").kind, Kind::kOther);
  EXPECT_EQ(trace.parse("     6)     7469.1  Error      0008  4  00 19 08 08").kind, Kind::kOther);
}

TEST(PcanTraceTest, ReadsAFileOfVersion21ByItsColumns) {
  PcanTrace trace;
  (void)trace.parse(";$FILEVERSION=2.1");
  (void)trace.parse(";$COLUMNS=N,O,T,B,I,d,R,L,D");
  const auto line = trace.parse("      1      1059.900 DT 1      0300 Rx -  7    00 00 00 00 04 00 00");
  ASSERT_EQ(line.kind, Kind::kFrame);
  EXPECT_EQ(line.utime, 1'059'900);
  EXPECT_EQ(line.bus, "1");
  EXPECT_EQ(line.frame, can::CanFrame::make(0x300, {0, 0, 0, 0, 4, 0, 0}));
  const auto remote = trace.parse("     10      1336.543 RR 1      0100 Rx -  3");
  EXPECT_EQ(remote.kind, Kind::kFrame);
  EXPECT_TRUE(remote.frame.remote);
  const auto extended = trace.parse("      9      1335.156 DT 2  18EFC034 Tx -  2    01 02");
  EXPECT_EQ(extended.frame.id, 0x18EFC034u);
  for (const char* other : {"      5      1334.416 FD 1      0500 Tx - 12    01 02 03 04 05 06 07 08 09 0A 0B 0C",
                            "      6      1334.222 ER 1         - Rx -  5    04 00 02 00 00",
                            "      7      1334.224 EV 1  User-defined event for bus 1"}) {
    EXPECT_EQ(trace.parse(other).kind, Kind::kOther) << other;
  }
}

/// One data frame, one of another bus, one remote, and what is none, in the columns of each version.
TEST(PcanTraceTest, ReadsAFileOfEveryOtherVersion) {
  struct Case {
    const char* heading;
    const char* data;
    const char* remote;
    std::vector<const char*> others;
    const char* bus;
  };
  for (const Case& c : std::vector<Case>{
           {";####\n;   C:\\drive.trc\n;   Start time: 11.09.2012 16:00:20.682",
            "     1)      2841  01A2  3  0A 0B FF",
            "     4)      2844  0100  3  RTR",
            {"     2)      2842  0008  4  ERROR 00 19 08 08",
             "     3)      2843  FFFFFFFF  4  00 00 00 04 -- -- -- -- BUSLIGHT"},
            ""},
           {";$FILEVERSION=1.2\n;$STARTTIME=25569.0;",
            "     1)      2841.000 2  Rx         01A2  3  0A 0B FF",
            "     7)      2844.250 2  Rx         0100  3  RTR",
            {"     5)      2842.834 1  Warng  FFFFFFFF  4  00 00 00 04  BUSLIGHT"},
            "2"},
           {";$FILEVERSION=1.3\n;$STARTTIME=25569",
            "     1)      2841.000 2  Rx         01A2 -  3    0A 0B FF",
            "     7)      2844.743 2  Tx         0100 -  3    RTR",
            {"     5)      2842.834 1  Warng  FFFFFFFF -  4    00 00 00 04  BUSLIGHT",
             "     6)      2842.900 1  Error      0008 -  4    00 19 08 08",
             "     8)      2843.100 1  Rx     18EBFF31 FF 20   00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F 10 11 "
             "12 13"},
            "2"},
           {" ;$FILEVERSION=2.0\n;$COLUMNS=N,O,T,I,d,l,D",
            "      1      2841.000 DT     01A2 Rx 3  0A 0B FF",
            "     10      2844.543 RR     0100 Rx 3",
            {"      6      2842.522 ER          Rx    04 00 02 00 00", "      8      2842.643 EC          Rx    02 02"},
            ""},
           {";$FILEVERSION=3.0\n;$COLUMNS=N,O,T,B,I,d,R,V,S,A,r,s,L,D",
            "      1      2841.000 DT 2       1A2 Rx - - - -        - - 3    0A 0B FF",
            "     10      2844.543 RR 2       100 Rx - - - -        - - 3",
            {"     14      2842.122 XL 1       100 Tx - 00 03 00000456 0 0 3    03 11 22 33"},
            "2"}}) {
    PcanTrace trace;
    std::istringstream heading(c.heading);
    for (std::string text; std::getline(heading, text);) EXPECT_EQ(trace.parse(text).kind, Kind::kComment) << text;
    EXPECT_EQ(trace.foreign_version(), "");
    const auto data = trace.parse(c.data);
    ASSERT_EQ(data.kind, Kind::kFrame) << c.data;
    EXPECT_EQ(data.frame, can::CanFrame::make(0x1A2, {0x0A, 0x0B, 0xFF})) << c.data;
    EXPECT_EQ(data.utime, 2'841'000) << c.data;
    EXPECT_EQ(data.bus, c.bus) << c.data;
    const auto remote = trace.parse(c.remote);
    ASSERT_EQ(remote.kind, Kind::kFrame) << c.remote;
    EXPECT_TRUE(remote.frame.remote) << c.remote;
    EXPECT_EQ(remote.frame.size, 3);
    for (const char* other : c.others) EXPECT_EQ(trace.parse(other).kind, Kind::kOther) << other;
  }
}

TEST(PcanTraceTest, TheDecimalSignMayBeAComma) {
  PcanTrace trace;
  (void)trace.parse(";$FILEVERSION=1.1");
  (void)trace.parse(";$STARTTIME=25570,5");
  const auto line = trace.parse("     3)         7,2  Rx         0300  4  01 A3 58 4D ");
  ASSERT_EQ(line.kind, Kind::kFrame);
  EXPECT_EQ(line.utime, 129'600'007'200);
  for (const char* text : {"1) 1,234.5 Rx 012 1 00", "1) 1,234,5 Rx 012 1 00", "1) , Rx 012 1 00"})
    EXPECT_EQ(trace.parse(text).kind, Kind::kRefused) << text;
}

/// A length code of 9 to 15 of a classical frame is 8 bytes; PCAN-Explorer names a J1939 message's address.
TEST(PcanTraceTest, LengthsOfOtherKinds) {
  PcanTrace trace;
  (void)trace.parse(";$FILEVERSION=2.1");
  const auto code = trace.parse("     12      1900.000 DT 1      0182 Rx -  15   00 11 22 33 44 55 66 77");
  ASSERT_EQ(code.kind, Kind::kFrame);
  EXPECT_EQ(code.frame, can::CanFrame::make(0x182, {0, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77}));
  const auto addressed = trace.parse("     13      1901.000 DT 1  18EF808B Rx 80 8    12 15 15 15 15 15 15 15");
  ASSERT_EQ(addressed.kind, Kind::kFrame);
  EXPECT_EQ(addressed.frame.id, 0x18EF808Bu);
  for (const char* line : {"1 1.0 DT 1 0182 Rx - 1786 00", "1 1.0 DT 1 0182 Rx - 2.5 00 00",
                           "1 1.0 DT 1 0182 Rx - 9 00", "1 1.0 DT 1 0182 Rx - x 00", "1 1.0 DT 1 0182 Rx - -1 00"})
    EXPECT_EQ(trace.parse(line).kind, Kind::kRefused) << line;
}

TEST(PcanTraceTest, WhatIsNoLineIsRefused) {
  for (const char* line : {"1) 2.0 Rx 0800 1 00", "1) 2.0 Rx 012 9 00", "1) 2.0 Rx 012 2 00", "1) 2.0 Rx 012 1 00 00",
                           "1) -2.0 Rx 012 1 00", "1) x Rx 012 1 00", "1) nan Rx 012 1 00", "1) 2.0 Rx 012 1 0G",
                           "1) 2.0 Rx", "1)", "nonsense", "1) 2.0 Rx 12345 1 00", "1) 1e300 Rx 012 1 00"}) {
    PcanTrace trace;
    (void)trace.parse(";$FILEVERSION=1.1");
    EXPECT_NE(trace.parse(line).kind, Kind::kFrame) << line;
  }
  PcanTrace trace;
  (void)trace.parse(";$COLUMNS=N,O,T");
  EXPECT_EQ(trace.parse("1 2.0 DT 1 012 Rx - 1 00").kind, Kind::kRefused);
}

TEST(PcanTraceTest, DamagedLinesOfEveryShapeAreSurvived) {
  std::mt19937 random(4);
  const std::string good = "     2)        72.1  Rx         010A  8  AB 02 22 0E 99 8C 00 00 ";
  const std::string columns = ";$COLUMNS=N,O,T,B,I,d,R,L,D";
  PcanTrace trace;
  (void)trace.parse(";$FILEVERSION=1.1");
  for (int i = 0; i < 200'000; ++i) {
    std::string text = i % 20 == 0 ? columns : good;
    text.resize(random() % (text.size() + 1));
    for (unsigned changes = random() % 4; changes > 0 && !text.empty(); --changes)
      text[random() % text.size()] = static_cast<char>(random() % 256);
    const auto line = trace.parse(text);
    ASSERT_LE(line.frame.size, 8);
  }
}

}  // namespace
}  // namespace curbstone::encoder::traces
