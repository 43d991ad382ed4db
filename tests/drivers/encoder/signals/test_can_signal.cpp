#include "drivers/encoder/signals/can_signal.hpp"

#include <gmock/gmock.h>

#include <random>

namespace curbstone::encoder::signals {
namespace {

using ::testing::HasSubstr;

std::int64_t raw_of(const char* text, std::initializer_list<std::uint8_t> bytes) {
  const CanSignal signal = CanSignal::parse(text);
  return signal.raw(can::CanFrame::make(signal.id, bytes)).value();
}
double value_of(const char* text, std::initializer_list<std::uint8_t> bytes) {
  return CanSignal::parse(text).value(raw_of(text, bytes));
}
std::string why(const char* text) {
  try {
    (void)CanSignal::parse(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(CanSignalTest, ReadsTheExamplesOfADbcFile) {
  EXPECT_DOUBLE_EQ(value_of("1F0 0|12@0- (0.01,250)", {0x80, 0x4A, 0x0F, 0, 0, 0, 0, 0}), 255.92);
  EXPECT_DOUBLE_EQ(value_of("1F0 7|1@0+", {0x80, 0x4A, 0x0F, 0, 0, 0, 0, 0}), 1);
  EXPECT_DOUBLE_EQ(value_of("1F0 6|6@0+ (0.1,0)", {0x80, 0x4A, 0x0F, 0, 0, 0, 0, 0}), 0);
  EXPECT_DOUBLE_EQ(value_of("1F0 0|12@0- (0.01,250)", {0xC0, 0x06, 0xE0, 0, 0, 0, 0, 0}), 250.55);
  EXPECT_DOUBLE_EQ(value_of("1F0 6|6@0+ (0.1,0)", {0xC0, 0x06, 0xE0, 0, 0, 0, 0, 0}), 3.2);
}

/// Wheel speeds as vehicles of several makers send them, and values of another program's.
TEST(CanSignalTest, ReadsWheelSpeedsOfAnyAlignment) {
  const std::initializer_list<std::uint8_t> bytes = {0x1A, 0x6F, 0x9C, 0x03, 0xF5, 0x80, 0x42, 0xDB};
  EXPECT_NEAR(value_of("0AA 7|16@0+ (0.01,-67.67)", bytes), 6767 * 0.01 - 67.67, 1e-12);
  EXPECT_EQ(raw_of("1D0 7|15@0+", bytes), 0x1A6F >> 1);
  EXPECT_EQ(raw_of("1D0 8|15@0+", bytes), 0x6F9C03 >> 2 & 0x7FFF);
  EXPECT_EQ(raw_of("386 48|14@1+", bytes), 0x1B42);
  EXPECT_EQ(raw_of("203 2|11@0+", bytes), 0x1A6F & 0x7FF) << "byte 0's bit 2 is the first";
  EXPECT_EQ(raw_of("052 13|13@1+", bytes), 0x039C6F1A >> 13 & 0x1FFF);
}

/// A DBC's text has blanks where this had none, and other files have 0x before the id.
TEST(CanSignalTest, BlanksAndAPrefixDoNotMatter) {
  for (const char* text : {"0xAA 7|16@0+ (0.01, -67.67)", "aa  7 | 16@0 +  ( 1E-2 , -67.67 ) ",
                           "\t0XaA\t7|16@0+\t(.01,-67.67)", "AA 7|16@0+(0.01,-67.67)"}) {
    EXPECT_EQ(why(text), "") << text;
    EXPECT_NEAR(value_of(text, {0x1A, 0x6F}), 0, 1e-12) << text;
  }
  EXPECT_THAT(why("0x 7|16@0+"), HasSubstr("the id has"));
  EXPECT_THAT(why("AA 7|16@0+ (0,01;0)"), HasSubstr("')' is missing"));
  EXPECT_THAT(why("AA : 7|16@0+"), HasSubstr("the start bit is no number"));
}

TEST(CanSignalTest, ReadsBothByteOrdersWithTheirSigns) {
  EXPECT_EQ(raw_of("181 0|32@1-", {0x2E, 0xFB, 0xFF, 0xFF, 0x2E, 0x16, 0, 0}), -1234);
  EXPECT_EQ(raw_of("181 32|32@1-", {0x2E, 0xFB, 0xFF, 0xFF, 0x2E, 0x16, 0, 0}), 5678);
  EXPECT_EQ(raw_of("181 7|32@0-", {0xFF, 0xFF, 0xFB, 0x2E, 0, 0, 0x16, 0x2E}), -1234);
  EXPECT_EQ(raw_of("181 39|32@0-", {0xFF, 0xFF, 0xFB, 0x2E, 0, 0, 0x16, 0x2E}), 5678);
  EXPECT_EQ(raw_of("181 3|12@0+", {0x0A, 0xBC}), 0xABC);
  EXPECT_EQ(raw_of("181 0|64@1-", {0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}), -2);
  EXPECT_DOUBLE_EQ(value_of("181 7|64@0+", {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}), 18446744073709551615.0);
}

TEST(CanSignalTest, AFrameThatIsTooShortOrRemoteHasNone) {
  const CanSignal little = CanSignal::parse("181 12|8@1+");
  EXPECT_FALSE(little.raw(can::CanFrame::make(0x181, {1, 2})));
  EXPECT_TRUE(little.raw(can::CanFrame::make(0x181, {1, 2, 3})));
  const CanSignal big = CanSignal::parse("181 3|12@0+");
  EXPECT_FALSE(big.raw(can::CanFrame::make(0x181, {1})));
  EXPECT_TRUE(big.raw(can::CanFrame::make(0x181, {1, 2})));
  can::CanFrame remote = can::CanFrame::make(0x181, {1, 2, 3});
  remote.remote = true;
  EXPECT_FALSE(little.raw(remote));
}

TEST(CanSignalTest, IdsOfElevenAndOf29BitsAreNeverMixed) {
  const CanSignal standard = CanSignal::parse("181 0|8@1+");
  const CanSignal extended = CanSignal::parse("00000181 0|8@1+");
  can::CanFrame frame = can::CanFrame::make(0x181, {1});
  EXPECT_TRUE(standard.is_in(frame));
  EXPECT_FALSE(extended.is_in(frame));
  frame.extended = true;
  EXPECT_FALSE(standard.is_in(frame));
  EXPECT_TRUE(extended.is_in(frame));
}

TEST(CanSignalTest, WhatIsNoSignalIsReportedInALine) {
  EXPECT_THAT(why("800 0|8@1+"), HasSubstr("up to 7FF"));
  EXPECT_THAT(why("2FFFFFFF 0|8@1+"), HasSubstr("up to 1FFFFFFF"));
  EXPECT_THAT(why("0181 0|8@1+"), HasSubstr("the id has"));
  EXPECT_THAT(why("181 60|8@1+"), HasSubstr("does not fit"));
  EXPECT_THAT(why("181 56|9@0+"), HasSubstr("does not fit"));
  EXPECT_THAT(why("181 0|65@1+"), HasSubstr("does not fit"));
  EXPECT_THAT(why("181 0|0@1+"), HasSubstr("does not fit"));
  EXPECT_THAT(why("181 -1|8@1+"), HasSubstr("does not fit"));
  EXPECT_THAT(why("181 0|8@2+"), HasSubstr("the byte order"));
  EXPECT_THAT(why("181 0|8@1"), HasSubstr("'-' is missing"));
  EXPECT_THAT(why("181 0|8@1+ (0,1)"), HasSubstr("the factor is not 0"));
  EXPECT_THAT(why("181 0|8@1+ (nan,1)"), HasSubstr("the factor is not 0"));
  EXPECT_THAT(why("181 0|8@1+ (1;1)"), HasSubstr("',' is missing"));
  EXPECT_THAT(why("181 0|8@1+ km"), HasSubstr("something follows"));
  EXPECT_THAT(why("181 0|999999999999@1+"), HasSubstr("the length is no number"));
  EXPECT_THAT(why(""), HasSubstr("expected e.g. \"181 0|32@1- (1,0)\""));
}

TEST(CanSignalTest, OverlapWhereTheyShareABitOfAFrame) {
  const auto overlap = [](const char* a, const char* b) {
    const bool found = CanSignal::parse(a).overlaps(CanSignal::parse(b));
    EXPECT_EQ(found, CanSignal::parse(b).overlaps(CanSignal::parse(a))) << a << ", " << b;
    return found;
  };
  EXPECT_TRUE(overlap("181 0|32@1-", "181 0|32@1-"));
  EXPECT_FALSE(overlap("181 0|32@1-", "182 0|32@1-"));
  EXPECT_FALSE(overlap("181 0|32@1-", "00000181 0|32@1-"));
  EXPECT_FALSE(overlap("181 0|32@1-", "181 32|32@1-"));
  EXPECT_TRUE(overlap("181 0|32@1-", "181 31|32@1-"));
  EXPECT_FALSE(overlap("1A0 7|16@0+", "1A0 23|16@0+"));
  EXPECT_TRUE(overlap("1A0 7|16@0+", "1A0 15|16@0+"));
  EXPECT_TRUE(overlap("1A0 7|16@0+", "1A0 0|16@1+")) << "the same two bytes, one of them with the wrong order";
  EXPECT_FALSE(overlap("1A0 7|12@0+", "1A0 8|4@1+"));
  EXPECT_TRUE(overlap("1A0 7|12@0+", "1A0 12|4@1+"));
  EXPECT_TRUE(overlap("1A0 7|64@0+", "1A0 63|1@1+"));
}

TEST(CanSignalTest, TextOfEveryShapeIsAcceptedOrRefusedAndWhatIsAcceptedCanBeRead) {
  std::mt19937 random(2);
  static constexpr std::string_view kLetters = "018F|@+-(,). e";
  int accepted = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::string text = "181 0|32@1- (1,0)";
    for (unsigned changes = random() % 4; changes > 0; --changes)
      text[random() % text.size()] = kLetters[random() % kLetters.size()];
    try {
      const CanSignal signal = CanSignal::parse(text);
      (void)signal.raw(can::CanFrame::make(signal.id, {1, 2, 3, 4, 5, 6, 7, 8}));
      ++accepted;
    } catch (const std::runtime_error&) {
    }
  }
  EXPECT_GT(accepted, 10'000);
}

}  // namespace
}  // namespace curbstone::encoder::signals
