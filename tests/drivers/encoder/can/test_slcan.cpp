#include "drivers/encoder/can/slcan.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/byte_stream.hpp"
#include "tools/simulate/devices/slcan_emulator.hpp"

namespace curbstone::encoder::can {
namespace {

using test::Bytes;
using test::from_text;

CanFrame frame(std::uint32_t id, bool extended, bool remote, const test::Bytes& data) {
  CanFrame f;
  f.id = id;
  f.extended = extended;
  f.remote = remote;
  f.size = static_cast<std::uint8_t>(data.size());
  if (!remote) std::copy(data.begin(), data.end(), f.data.begin());
  return f;
}

TEST(SlcanFrameTest, LinesAreThoseOfTheManual) {
  EXPECT_EQ(encode_slcan(frame(0x100, false, false, {0x11, 0x22, 0x33})), test::from_text("t1003112233\r"));
  EXPECT_EQ(encode_slcan(frame(0x123, true, false, {0xAB})), test::from_text("T000001231AB\r"));
  EXPECT_EQ(encode_slcan(frame(0x7FF, false, true, {0, 0})), test::from_text("r7FF2\r"));
  EXPECT_EQ(encode_slcan(frame(0x1FFFFFFF, true, true, {})), test::from_text("R1FFFFFFF0\r"));
}

TEST(SlcanFrameTest, ReadsAllFourKindsAndToleratesATimeStamp) {
  EXPECT_EQ(parse_slcan_frame("t18182EFBFFFF2E160000"),
            frame(0x181, false, false, {0x2E, 0xFB, 0xFF, 0xFF, 0x2E, 0x16, 0, 0}));
  EXPECT_EQ(parse_slcan_frame("t18182EFBFFFF2E1600001A2B"), parse_slcan_frame("t18182efbffff2e160000"));
  EXPECT_EQ(parse_slcan_frame("T000001231AB"), frame(0x123, true, false, {0xAB}));
  EXPECT_EQ(parse_slcan_frame("r7FF2"), frame(0x7FF, false, true, {0, 0}));
  EXPECT_EQ(parse_slcan_frame("R1FFFFFFF0"), frame(0x1FFFFFFF, true, true, {}));
  EXPECT_EQ(parse_slcan_frame("t7010"), frame(0x701, false, false, {}));
}

TEST(SlcanFrameTest, WhatIsNotExactlyAFrameIsRefused) {
  for (const char* line :
       {"", "t", "t18", "t181", "t1819", "t1812AA", "t1812AABBC", "t1812AABBCCDDE", "t1812AAGG", "t8001AA",
        "T200000001AA", "tx811AA", "t-811AA", "x1811AA", "t1811AA ", "t181100x1", "r1812AABB1"}) {
    EXPECT_FALSE(parse_slcan_frame(line)) << line;
  }
}

struct Collector {
  std::vector<CanFrame> frames;
  int ok = 0;
  int refused = 0;
  SlcanParser::Handlers handlers() {
    return {[this](const CanFrame& f) { frames.push_back(f); },
            [this](SlcanParser::Answer answer) { ++(answer == SlcanParser::Answer::kOk ? ok : refused); }};
  }
};

TEST(SlcanParserTest, TellsFramesAnswersAndGarbageApart) {
  SlcanParser parser;
  Collector got;
  parser.parse(test::from_text("\r\at1811AA\rz\rZ\rV1013\rF00\rrubbish\r1811AA\rt7011"), got.handlers());
  parser.parse(test::from_text("05\r"), got.handlers());
  EXPECT_THAT(got.frames, ::testing::ElementsAre(frame(0x181, false, false, {0xAA}), frame(0x701, false, false, {5})));
  EXPECT_EQ(got.ok, 3);
  EXPECT_EQ(got.refused, 1);
  EXPECT_EQ(parser.counters()["refused.slcan_line"], 2);
}

TEST(SlcanParserTest, AFrameAtTheEndOfASpoiltLineIsRead) {
  SlcanParser parser;
  Collector got;
  parser.parse(test::from_text("t1818112233t1811AA\r\x80\xfft18108\r"),
               got.handlers());  // bytes were lost: and a CR
  EXPECT_THAT(got.frames, ::testing::ElementsAre(frame(0x181, false, false, {0xAA})));
  EXPECT_EQ(parser.counters()["refused.slcan_line"], 2);
}

TEST(SlcanParserTest, AnEndlessLineIsBoundedAndTheNextOneIsRead) {
  SlcanParser parser;
  Collector got;
  for (int i = 0; i < 1000; ++i) parser.parse(test::Bytes(100, 't'), got.handlers());
  parser.parse(test::from_text("\rt1811AA\r"), got.handlers());
  EXPECT_EQ(got.frames.size(), 1u);
  EXPECT_EQ(parser.counters()["refused.slcan_overlong"], 1);
}

/// Of an adapter for CAN FD, on a bus with other nodes that use it.
TEST(SlcanParserTest, FramesOfCanFdAreIgnoredAndNotRefused) {
  SlcanParser parser;
  Collector got;
  const std::string data(128, 'A');
  for (const char* line :
       {"d1812AABB", "b1819AABBCCDDEEFF001122334455", "D000001810", "B0000018191122334455667788AABBCCDD",
        "d18190102030405060708090A0B0C1F2E"})  // the last one with a time stamp
    parser.parse(test::from_text(std::string(line) + "\r"), got.handlers());
  parser.parse(test::from_text("b181F" + data + "\rB00000181F" + data + "1F2E\rt1811AA\r"), got.handlers());
  EXPECT_EQ(parser.counters()["ignored.slcan_fd"], 7);
  EXPECT_EQ(parser.counters()["refused.slcan_line"], 0);
  EXPECT_EQ(parser.counters()["refused.slcan_overlong"], 0);
  EXPECT_THAT(got.frames, ::testing::ElementsAre(frame(0x181, false, false, {0xAA})));
  for (const char* line : {"d1812AAB", "d8122AABB", "b181GAA", "bad", "d", "D1812AABB"})
    parser.parse(test::from_text(std::string(line) + "\r"), got.handlers());
  EXPECT_EQ(parser.counters()["refused.slcan_line"], 6);
}

TEST(SlcanParserTest, SurvivesNoiseAndReadsEveryGoodLineAfterACarriageReturn) {
  std::mt19937 random(11);
  SlcanParser parser;
  Collector got;
  const CanFrame good = frame(0x181, false, false, {1, 2, 3, 4, 5, 6, 7, 8});
  const std::string alphabet = "tTrR0123456789ABCDEFabcdef\r\azZ";
  std::int64_t found = 0;
  for (int i = 0; i < 5000; ++i) {
    test::Bytes noise = test::random_bytes(random, random() % 40);
    if (random() % 2 == 0) {
      for (auto& byte : noise) byte = static_cast<std::uint8_t>(alphabet[byte % alphabet.size()]);
    }
    noise.push_back('\r');
    test::append(noise, encode_slcan(good));
    got.frames.clear();
    parser.parse(noise, got.handlers());
    ASSERT_FALSE(got.frames.empty());
    found += got.frames.back() == good;
    for (const CanFrame& f : got.frames) {
      EXPECT_LE(f.size, 8);
      EXPECT_LE(f.id, f.extended ? 0x1FFFFFFFu : 0x7FFu);
    }
  }
  EXPECT_EQ(found, 5000);
}

TEST(SlcanEmulatorTest, OpensOnlyWithASpeedAndPassesFramesBothWaysWhileOpen) {
  simulate::devices::SlcanEmulator adapter;
  const CanFrame one = frame(0x181, false, false, {0xAA});
  EXPECT_EQ(adapter.on_bytes(test::from_text("O\r")).to_host, test::from_text("\a"));
  EXPECT_EQ(adapter.on_bytes(test::from_text("S6\rO\r")).to_host, test::from_text("\r\r"));
  EXPECT_EQ(adapter.on_frame(one), test::from_text("t1811AA\r"));
  const auto sent = adapter.on_bytes(test::from_text("t601840641000"));
  EXPECT_TRUE(sent.to_bus.empty());
  EXPECT_EQ(adapter.on_bytes(test::from_text("00000000\r")).to_bus.size(), 1u);
  EXPECT_EQ(adapter.on_bytes(test::from_text("C\r")).to_host, test::from_text("\r"));
  EXPECT_TRUE(adapter.on_frame(one).empty());
}

}  // namespace
}  // namespace curbstone::encoder::can
