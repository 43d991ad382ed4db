#include "drivers/lidar/sources/one_sender.hpp"

#include <gtest/gtest.h>

namespace curbstone::lidar::sources {
namespace {

constexpr Ipv4 kFirst = 0xC0A801C8;   // 192.168.1.200
constexpr Ipv4 kSecond = 0xC0A801C9;  // 192.168.1.201

class OneSenderTest : public ::testing::Test {
 protected:
  using Kind = OneSender::Kind;
  bool admits(Ipv4 sender, Kind kind = Kind::kPoints) { return sender_.admits(sender, now_, kind); }

  OneSender sender_;
  std::int64_t now_ = 1'700'000'000'000'000;  // us
};

TEST_F(OneSenderTest, OfTwoDevicesTheFirstIsReadAndBothAreNamed) {
  for (int i = 0; i < 100; ++i, now_ += 1'333) {
    EXPECT_TRUE(admits(kFirst));
    EXPECT_FALSE(admits(kSecond));
  }
  EXPECT_EQ(sender_.foreign(), 100);
  EXPECT_EQ(sender_.fault(now_),
            "two devices send: 192.168.1.200 is read, 192.168.1.201 is not; give each a port of its own, or set "
            "device_address");
}

TEST_F(OneSenderTest, ADeviceThatWasReplacedIsFollowedAfterASecond) {
  EXPECT_TRUE(admits(kFirst));
  now_ += OneSender::kSilence / 2;
  EXPECT_FALSE(admits(kSecond));
  now_ += OneSender::kSilence / 2 + 1;
  EXPECT_FALSE(sender_.is_another());
  EXPECT_TRUE(admits(kSecond));
  EXPECT_TRUE(sender_.is_another());
  EXPECT_EQ(sender_.fault(now_), "") << "it is the only one";
  EXPECT_FALSE(admits(kFirst));
}

TEST_F(OneSenderTest, TheFaultIsOverOnceTheOtherIsSilent) {
  EXPECT_TRUE(admits(kFirst));
  EXPECT_FALSE(admits(kSecond));
  EXPECT_NE(sender_.fault(now_), "");
  for (int i = 0; i < 1000; ++i, now_ += 1'333) EXPECT_TRUE(admits(kFirst));
  EXPECT_EQ(sender_.fault(now_), "");
}

TEST_F(OneSenderTest, TheFaultIsOverOnceBothAreSilent) {
  EXPECT_TRUE(admits(kFirst));
  EXPECT_FALSE(admits(kSecond));
  EXPECT_NE(sender_.fault(now_ + OneSender::kSilence), "");
  EXPECT_EQ(sender_.fault(now_ + OneSender::kSilence + 1), "");
}

TEST_F(OneSenderTest, TheFaultIsOverOnceTheClockWasSetBack) {
  EXPECT_TRUE(admits(kFirst));
  EXPECT_FALSE(admits(kSecond));
  EXPECT_EQ(sender_.fault(now_ - 3'600'000'000), "");
}

TEST_F(OneSenderTest, PacketsOfOtherModelsAreNotItsBusiness) {
  EXPECT_TRUE(admits(kSecond, Kind::kForeign)) << "to be refused by what it is";
  EXPECT_TRUE(admits(kFirst)) << "so it is no first device";
  EXPECT_EQ(sender_.foreign(), 0);
}

TEST_F(OneSenderTest, AClockThatWasSetBackIsNoSilenceForEver) {
  EXPECT_TRUE(admits(kFirst));
  now_ -= 3'600'000'000;
  EXPECT_TRUE(admits(kSecond));
  EXPECT_FALSE(admits(kFirst));
}

/// Each of two devices has a port of its own for its points, and both send their information to the one of the maker.
TEST_F(OneSenderTest, ADeviceWithoutPointsIsGivenUpForOneThatSendsThem) {
  for (int i = 0; i < 30; ++i, now_ += 100'000) EXPECT_TRUE(admits(kSecond, Kind::kInfo));
  EXPECT_FALSE(sender_.is_another());
  for (int i = 0; i < 1000; ++i, now_ += 1'333) {
    ASSERT_TRUE(admits(kFirst));
    ASSERT_EQ(sender_.is_another(), i == 0) << "what the second one said is not true of the first";
    ASSERT_EQ(admits(kSecond, Kind::kInfo), false);
  }
  EXPECT_TRUE(admits(kFirst, Kind::kInfo));
  EXPECT_NE(sender_.fault(now_), "");
  now_ += 60'000'000;  // the first one starts again
  EXPECT_FALSE(admits(kSecond, Kind::kInfo));
  EXPECT_TRUE(admits(kFirst));
  EXPECT_FALSE(sender_.is_another());
}

}  // namespace
}  // namespace curbstone::lidar::sources
