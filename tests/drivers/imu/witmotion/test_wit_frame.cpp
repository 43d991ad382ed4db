#include "drivers/imu/witmotion/wit_frame.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/byte_stream.hpp"

namespace curbstone::imu::witmotion {
namespace {

using test::append;
using test::Bytes;
using test::from_hex;
using ::testing::ElementsAre;

class WitParserTest : public ::testing::Test {
 protected:
  std::vector<int> parse(const test::Bytes& bytes) {
    std::vector<int> ids;
    parser_.parse(bytes, [&](const WitFrame& frame) { ids.push_back(frame.id); });
    return ids;
  }
  std::int64_t count(std::string_view name) const { return parser_.counters()[name]; }

  WitParser parser_;
  const test::Bytes acceleration_ = test::from_hex("55 51 00 00 00 00 00 08 CA 09 81");
  const test::Bytes rate_ = test::from_hex("55 52 00 00 00 00 66 06 CA 09 E6");
  const test::Bytes angle_ = test::from_hex("55 53 00 20 00 F0 00 40 00 00 F8");
  const test::Bytes quaternion_ = test::from_hex("55 59 FF 7F 00 00 00 00 00 00 2C");
};

TEST_F(WitParserTest, ReadsTheWorkedFramesAndTheirWords) {
  test::Bytes bytes;
  for (const auto& frame : {acceleration_, rate_, angle_, quaternion_}) test::append(bytes, frame);
  std::vector<std::vector<int>> words;
  parser_.parse(bytes, [&](const WitFrame& frame) {
    words.push_back({frame.id, frame.word(0), frame.word(1), frame.word(2), frame.word(3)});
  });
  EXPECT_THAT(words, ElementsAre(ElementsAre(0x51, 0, 0, 2048, 2506), ElementsAre(0x52, 0, 0, 1638, 2506),
                                 ElementsAre(0x53, 8192, -4096, 16384, 0), ElementsAre(0x59, 32767, 0, 0, 0)));
  EXPECT_EQ(count("garbage_bytes"), 0);
}

TEST_F(WitParserTest, EncodesWhatItReads) {
  EXPECT_EQ(encode_wit(0x51, std::span(acceleration_).subspan(2, 8)), acceleration_);
}

TEST_F(WitParserTest, CuttingTheStreamChangesNothing) {
  test::Bytes bytes = test::from_hex("55 55 51 07");
  for (const auto& frame : {acceleration_, rate_, angle_, quaternion_}) test::append(bytes, frame);
  std::vector<int> ids;
  for (const std::uint8_t byte : bytes) {
    for (const int id : parse({byte})) ids.push_back(id);
  }
  EXPECT_THAT(ids, ElementsAre(0x51, 0x52, 0x53, 0x59));
  EXPECT_EQ(count("garbage_bytes"), 4);
}

TEST_F(WitParserTest, TheFirstFrameCountsOnlyIfAnotherFollowsAtOnce) {
  EXPECT_THAT(parse(acceleration_), ElementsAre());
  EXPECT_THAT(parse(rate_), ElementsAre(0x51, 0x52));
}

TEST_F(WitParserTest, ADamagedFrameCostsItselfAndIsSeenAsAGap) {
  test::Bytes damaged = rate_;
  damaged[4] ^= 0x40;
  test::Bytes bytes;
  for (const auto& frame : {angle_, quaternion_, acceleration_, damaged, angle_}) test::append(bytes, frame);
  test::append(bytes, quaternion_);
  std::vector<int> ids, gaps;
  parser_.parse(bytes, [&](const WitFrame& frame) {
    ids.push_back(frame.id);
    if (frame.after_gap) gaps.push_back(frame.id);
  });
  EXPECT_THAT(ids, ElementsAre(0x53, 0x59, 0x51, 0x53, 0x59));
  EXPECT_THAT(gaps, ElementsAre(0x53));
  EXPECT_EQ(count("refused.checksum"), 1);
  EXPECT_EQ(count("garbage_bytes"), 11);
}

TEST_F(WitParserTest, GoodFramesSurviveNoiseAndNoiseMakesNone) {
  std::mt19937 random(7);
  int found = 0, wrong = 0;
  constexpr int kRounds = 5000;
  for (int round = 0; round < kRounds; ++round) {
    test::Bytes bytes = test::random_bytes(random, random() % 30);
    for (auto& byte : bytes) byte = random() % 4 == 0 ? 0x55 : byte;
    for (const auto& frame : {acceleration_, rate_, angle_, quaternion_}) test::append(bytes, frame);
    parser_.parse(bytes, [&](const WitFrame& frame) {
      const bool known = frame.id == 0x51 || frame.id == 0x52 || frame.id == 0x53 || frame.id == 0x59;
      found += known ? 1 : 0;
      wrong += known ? 0 : 1;
    });
  }
  EXPECT_GT(found, 4 * kRounds * 95 / 100);
  EXPECT_LT(wrong, kRounds / 500);
}

}  // namespace
}  // namespace curbstone::imu::witmotion
