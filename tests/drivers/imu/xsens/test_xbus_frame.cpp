#include "drivers/imu/xsens/xbus_frame.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/byte_stream.hpp"
#include "tests/paths.hpp"

namespace curbstone::imu::xsens {
namespace {

using test::append;
using test::Bytes;
using test::from_hex;

struct Parsed {
  std::uint8_t mid;
  test::Bytes data;
  bool operator==(const Parsed&) const = default;
};

class XbusParserTest : public ::testing::Test {
 protected:
  std::vector<Parsed> parse(const test::Bytes& bytes, std::int64_t now = 0) {
    std::vector<Parsed> frames;
    parser_.parse(now, bytes, [&](const XbusFrame& frame) {
      frames.push_back({frame.mid, test::Bytes(frame.data.begin(), frame.data.end())});
    });
    return frames;
  }
  std::int64_t count(std::string_view name) const { return parser_.counters()[name]; }

  XbusParser parser_;
  const test::Bytes ack_ = test::from_hex("FA FF 31 00 D0");
  const test::Bytes error_ = test::from_hex("FA FF 42 01 04 BA");
};

TEST(XbusFrameTest, CommandsAreTheBytesOfTheManual) {
  EXPECT_EQ(encode_xbus(Mid::kGotoConfig), test::from_hex("FA FF 30 00 D1"));
  EXPECT_EQ(encode_xbus(Mid::kGotoMeasurement), test::from_hex("FA FF 10 00 F1"));
  EXPECT_EQ(encode_xbus(Mid::kWakeUpAck), test::from_hex("FA FF 3F 00 C2"));
  EXPECT_EQ(encode_xbus(Mid::kReset), test::from_hex("FA FF 40 00 C1"));
  EXPECT_EQ(encode_xbus(Mid::kSetOutputConfiguration,
                        test::from_hex("10 20 FF FF 10 60 FF FF 20 10 00 64 40 20 00 64 80 20 00 64 E0 20 FF FF")),
            test::from_hex("FA FF C0 18 10 20 FF FF 10 60 FF FF 20 10 00 64 40 20 00 64 80 20 00 64 E0 20 FF FF 33"));
}

TEST_F(XbusParserTest, ReadsFramesWithAndWithoutData) {
  test::Bytes bytes = ack_;
  test::append(bytes, error_);
  EXPECT_THAT(parse(bytes), ::testing::ElementsAre(Parsed{0x31, {}}, Parsed{0x42, {0x04}}));
  EXPECT_EQ(count("frames"), 2);
  EXPECT_EQ(count("garbage_bytes"), 0);
}

TEST_F(XbusParserTest, CuttingTheStreamChangesNothing) {
  test::Bytes bytes = error_;
  test::append(bytes, test::from_hex("00 FA 12"));
  test::append(bytes, ack_);
  test::append(bytes, error_);
  std::vector<Parsed> frames;
  for (const std::uint8_t byte : bytes) {
    for (const Parsed& frame : parse({byte})) frames.push_back(frame);
  }
  EXPECT_EQ(frames.size(), 3u);
  EXPECT_EQ(count("garbage_bytes"), 3);
}

TEST_F(XbusParserTest, ExtendedLengthIsRoundTripped) {
  const test::Bytes payload(300, 0xFA);
  const test::Bytes wire = encode_xbus(Mid::kMtData2, payload);
  ASSERT_EQ(wire.size(), 307u);
  EXPECT_EQ(wire[3], 0xFF);
  EXPECT_EQ(wire[4], 1);
  EXPECT_EQ(wire[5], 44);
  EXPECT_THAT(parse(wire), ::testing::ElementsAre(Parsed{0x36, payload}));
}

TEST_F(XbusParserTest, AFrameInsideAFailedCandidateIsFound) {
  test::Bytes bytes = test::from_hex("FA FF 36 08");  // claims 8 bytes and swallows what follows
  test::append(bytes, ack_);
  test::append(bytes, error_);
  EXPECT_THAT(parse(bytes), ::testing::ElementsAre(Parsed{0x31, {}}, Parsed{0x42, {0x04}}));
  EXPECT_EQ(count("refused.checksum"), 1);
  EXPECT_EQ(count("garbage_bytes"), 4);
}

/// A stream of messages of one kind: the header of the next one inside tells it, though no more has come yet.
TEST_F(XbusParserTest, ACutFrameThatIsCompletedByTheBeginningOfItsLikeIsRefusedByteByByte) {
  const test::Bytes payload = test::from_hex("10 20 02 00 07 E0 20 04 00 00 00 01");
  const test::Bytes next = encode_xbus(Mid::kMtData2, payload);
  for (int tail = 0; tail < 256; ++tail) {  // for one of them the sum is right
    parser_.reset();
    test::Bytes bytes = test::from_hex("FA FF 36 0C 10 20 02 00 06");
    bytes.push_back(static_cast<std::uint8_t>(tail));
    test::append(bytes, next);
    std::vector<Parsed> frames;
    for (const std::uint8_t byte : bytes) {
      for (const Parsed& frame : parse({byte})) frames.push_back(frame);
    }
    EXPECT_THAT(frames, ::testing::ElementsAre(Parsed{0x36, payload})) << tail;
  }
  EXPECT_EQ(count("refused.overlap"), 1);
}

TEST_F(XbusParserTest, ACutFrameThatIsCompletedByItsFollowerWithTheRightSumIsRefused) {
  for (int tail = 0; tail < 256; ++tail) {  // for one of them the sum is right
    parser_.reset();
    test::Bytes bytes = test::from_hex("FA FF 36 05");
    bytes.push_back(static_cast<std::uint8_t>(tail));  // then the end of it is missing
    test::append(bytes, error_);
    test::append(bytes, ack_);
    EXPECT_THAT(parse(bytes), ::testing::ElementsAre(Parsed{0x42, {0x04}}, Parsed{0x31, {}})) << tail;
  }
  EXPECT_EQ(count("refused.overlap"), 1);
}

TEST_F(XbusParserTest, AGoodFrameBeforeNoiseIsNoOverlap) {
  test::Bytes bytes = error_;
  test::append(bytes, test::from_hex("00 00"));
  EXPECT_THAT(parse(bytes), ::testing::ElementsAre(Parsed{0x42, {0x04}}));
}

TEST_F(XbusParserTest, WrongBusIdsAndAbsurdLengthsAreRefusedAtOnce) {
  test::Bytes bytes = test::from_hex("FA 37 36 00 93");      // bus id 37
  test::append(bytes, test::from_hex("FA FF 36 FF FF FF"));  // 65535 bytes
  test::append(bytes, test::from_hex("FA FF 36 FF 00 10"));  // extended form of a short frame
  test::append(bytes, test::from_hex("FA FF 31 FF 01 00"));  // an acknowledgement of 256 bytes
  test::append(bytes, ack_);
  EXPECT_THAT(parse(bytes), ::testing::ElementsAre(Parsed{0x31, {}}));
  EXPECT_EQ(count("refused.header"), 4);
}

TEST_F(XbusParserTest, ACandidateThatNeverCompletesIsDroppedAfterItsPatience) {
  EXPECT_TRUE(parse(test::from_hex("FA FF 36 FF 08 00"), 1'000'000).empty());  // 2048 bytes to come
  EXPECT_TRUE(parse(ack_, 1'100'000).empty());                                 // swallowed as its data
  EXPECT_THAT(parse(error_, 1'400'000), ::testing::ElementsAre(Parsed{0x31, {}}, Parsed{0x42, {0x04}}));
  EXPECT_EQ(count("refused.incomplete"), 1);
}

TEST_F(XbusParserTest, GarbageBeforeAndBetweenFramesIsSkippedAndCounted) {
  test::Bytes bytes = test::from_hex("FA FA FA 00 FF");
  test::append(bytes, ack_);
  EXPECT_EQ(parse(bytes).size(), 1u);
  EXPECT_EQ(count("garbage_bytes"), 5);
}

TEST_F(XbusParserTest, RecordingsOfRealDevicesParseWithoutARefusal) {
  for (int i = 1; i <= 5; ++i) {
    const test::Bytes bytes = test::read_bytes(test::data_path("imu_xsens/") + std::to_string(i) + ".output.bin");
    if (bytes.empty()) GTEST_SKIP() << test::data_path("imu_xsens/") << i << ".output.bin is not there";
    XbusParser parser;
    int mtdata2 = 0;
    parser.parse(0, bytes, [&](const XbusFrame& frame) { mtdata2 += frame.is(Mid::kMtData2); });
    EXPECT_EQ(mtdata2, 100) << i;
    EXPECT_EQ(parser.counters()["refused.checksum"], 0) << i;
    EXPECT_EQ(parser.counters()["garbage_bytes"], 0) << i;
  }
}

TEST_F(XbusParserTest, NoBytesAreReturnedAsFramesUnlessTheChecksumHoldsAndGoodFramesSurviveNoise) {
  std::mt19937 random(7);
  int good = 0;
  int found = 0;
  for (int round = 0; round < 2000; ++round) {
    test::Bytes bytes = test::random_bytes(random, random() % 40);
    for (auto& byte : bytes) byte = random() % 4 == 0 ? 0xFA : byte;
    test::Bytes payload = test::random_bytes(random, random() % 300);
    test::Bytes frame = encode_xbus(Mid::kMtData2, payload);
    if (random() % 3 == 0) frame[random() % frame.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    if (random() % 5 == 0) frame.resize(random() % frame.size());
    test::append(bytes, frame);
    test::append(bytes, ack_);
    ++good;
    for (const Parsed& parsed : parse(bytes, round * 300'000)) found += parsed.mid == 0x31 && parsed.data.empty();
  }
  found += static_cast<int>(parse(ack_, 3'000'000'000).size());
  EXPECT_GT(found, good * 95 / 100);
}

}  // namespace
}  // namespace curbstone::imu::xsens
