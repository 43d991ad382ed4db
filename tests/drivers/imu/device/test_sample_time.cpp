#include "drivers/imu/device/sample_time.hpp"

#include <gtest/gtest.h>

#include <random>

namespace curbstone::imu::device {
namespace {

using Verdict = SampleTime::Verdict;

/// A device that sends each `interval` ticks, and the host's clock beside it.
class SampleTimeTest : public ::testing::Test {
 protected:
  /// The next sample, `n` intervals on, says `ticks`.
  SampleTime::Result next(std::int64_t n = 1, std::int64_t error = 0) {
    ticks_ += n * interval_;
    received_ += n * interval_ * SampleTime::kTick;
    return send(static_cast<std::uint32_t>(ticks_ + error), static_cast<int>(n));
  }
  SampleTime::Result send(std::uint32_t ticks, int ahead) {
    const auto result = time_.next(ticks, received_, counted_ ? std::optional(ahead + refused_) : std::nullopt);
    refused_ = result.verdict == Verdict::kRefused ? refused_ + ahead : 0;
    return result;
  }
  void settle(int samples = 10) {
    for (int i = 0; i < samples; ++i) ASSERT_EQ(next().verdict, Verdict::kContinues);
  }

  SampleTime time_;
  std::int64_t interval_ = 100;  // ticks
  std::int64_t ticks_ = 51'703'023;
  std::int64_t received_ = 1'700'000'000'000'000;
  bool counted_ = true;
  int refused_ = 0;
};

TEST_F(SampleTimeTest, ATickIsATenthOfAMillisecond) {
  EXPECT_EQ(next().time, 5'170'312'300);
  EXPECT_EQ(next().time, 5'170'322'300);
}

TEST_F(SampleTimeTest, UnwrapsAfterTwoToThe32) {
  ticks_ = 0xFFFFFFF0u - 1000;
  settle();
  const std::int64_t before = ticks_ * SampleTime::kTick;
  const auto after = next();
  EXPECT_EQ(after.verdict, Verdict::kContinues);
  EXPECT_EQ(after.time - before, 10'000);
}

TEST_F(SampleTimeTest, UnwrapsAfterADay) {
  ticks_ = 863'999'950 - 1000;
  settle();
  const std::int64_t before = ticks_ * SampleTime::kTick;
  ticks_ -= 864'000'000;
  EXPECT_EQ(next().time - before, 10'000);
  EXPECT_EQ(next().time - before, 20'000);
}

TEST_F(SampleTimeTest, PassesADayWithoutAWrapOnDevicesThatCountFurther) {
  ticks_ = 863'999'950 - 1000;
  settle();
  const std::int64_t before = ticks_ * SampleTime::kTick;
  EXPECT_EQ(next().time - before, 10'000);
}

TEST_F(SampleTimeTest, ARestartIsBelievedWithTheSecondSample) {
  settle();
  ticks_ = 20;
  EXPECT_EQ(next().verdict, Verdict::kRefused);
  const auto second = next();
  EXPECT_EQ(second.verdict, Verdict::kRestarted);
  EXPECT_EQ(second.time, (20 + 200) * SampleTime::kTick);
  EXPECT_EQ(next().verdict, Verdict::kContinues);
}

TEST_F(SampleTimeTest, ASingleWrongTimeCostsItsSampleWithOrWithoutACounter) {
  for (const bool counted : {true, false}) {
    for (const std::int64_t error : {20'000LL, -20'000LL, 36'000'000LL, -36'000'000LL, 864'000'000LL, 300LL, -300LL}) {
      SCOPED_TRACE(testing::Message() << counted << " " << error);
      time_ = {};
      refused_ = 0;
      counted_ = counted;
      settle();
      const std::int64_t before = ticks_ * SampleTime::kTick;
      if (!counted && error == 300) continue;  // as if three samples had been lost: nothing tells
      EXPECT_EQ(next(1, error).verdict, Verdict::kRefused);
      const auto after = next();
      EXPECT_EQ(after.verdict, Verdict::kContinues);
      EXPECT_EQ(after.time - before, 20'000);
    }
  }
}

TEST_F(SampleTimeTest, AnyFlippedBitOfATimeCostsAtMostItsSample) {
  for (int bit = 2; bit < 32; ++bit) {  // below: within the device's own rounding
    SCOPED_TRACE(bit);
    time_ = {};
    refused_ = 0;
    settle();
    ticks_ += interval_;
    received_ += 10'000;
    EXPECT_EQ(send(static_cast<std::uint32_t>(ticks_) ^ (1u << bit), 1).verdict, Verdict::kRefused);
    EXPECT_EQ(next().verdict, Verdict::kContinues);
  }
}

TEST_F(SampleTimeTest, AWrongFirstTimeCostsTheSampleAfterIt) {
  next(1, 1'000'000);
  EXPECT_EQ(next().verdict, Verdict::kRefused);
  EXPECT_EQ(next().verdict, Verdict::kRestarted);
  settle();
}

TEST_F(SampleTimeTest, TheSameMessageTwiceIsSeen) {
  settle();
  EXPECT_EQ(send(static_cast<std::uint32_t>(ticks_), 0).verdict, Verdict::kRepeated);
  EXPECT_EQ(next().verdict, Verdict::kContinues);
}

TEST_F(SampleTimeTest, LostSamplesAreCountedByTheirTime) {
  settle();
  EXPECT_EQ(next(4).missing, 3);
  EXPECT_EQ(next().missing, 0);
}

TEST_F(SampleTimeTest, TheTimeGoesOnAfterAPauseOfAnyLength) {
  for (const bool counted : {true, false}) {
    counted_ = counted;
    settle();
    for (const std::int64_t n : {101, 12'345, 70'000}) {  // more than the 16-bit counter tells
      ticks_ += n * interval_;
      received_ += n * interval_ * SampleTime::kTick;
      EXPECT_EQ(send(static_cast<std::uint32_t>(ticks_), static_cast<int>(n % 65536)).verdict, Verdict::kContinues)
          << n;
    }
  }
}

TEST_F(SampleTimeTest, WhatWaitedForAHostThatWasStoppedIsBelieved) {
  settle();
  received_ += 3'000'000;
  for (int i = 0; i < 40; ++i) {  // all with one time of receipt
    ticks_ += interval_;
    EXPECT_EQ(send(static_cast<std::uint32_t>(ticks_), 1).verdict, Verdict::kContinues);
  }
  ticks_ += 260 * interval_;  // and the rest was too much for the kernel's buffer
  EXPECT_EQ(send(static_cast<std::uint32_t>(ticks_), 260).verdict, Verdict::kContinues);
  settle();
}

TEST_F(SampleTimeTest, TheHostsClockMayBeSet) {
  settle();
  received_ += 3'600'000'000;
  settle();
  received_ -= 7'200'000'000;
  settle();
}

TEST_F(SampleTimeTest, OtherRatesAreFollowed) {
  for (const std::int64_t interval : {25, 200, 5, 167, 1000}) {
    interval_ = interval;
    int used = 0;
    for (int i = 0; i < 30; ++i) used += next().verdict != Verdict::kRefused;
    EXPECT_GE(used, 20) << interval;
    settle();
  }
}

TEST_F(SampleTimeTest, ARateThatIsNoWholeNumberOfTicksIsFollowed) {
  for (int i = 1; i < 1000; ++i) {  // 60 Hz
    const auto ticks = static_cast<std::uint32_t>(ticks_ + (i * 10'000 + 30) / 60);
    received_ += 16'667;
    EXPECT_EQ(send(ticks, 1).verdict, Verdict::kContinues) << i;
  }
}

TEST_F(SampleTimeTest, ADeviceThatSamplesABitLateAtTimesIsBelieved) {
  std::mt19937 random(2);
  int used = 0, restarted = 0;
  const std::int64_t begin = ticks_;
  for (int i = 1; i <= 10'000; ++i) {
    const std::int64_t late = static_cast<std::int64_t>(random() % 20 == 0 ? random() % 40 : random() % 3);
    received_ += 10'000;
    const auto verdict = send(static_cast<std::uint32_t>(begin + i * interval_ + late), 1).verdict;
    used += verdict == Verdict::kContinues;
    restarted += verdict == Verdict::kRestarted;
  }
  EXPECT_GT(used, 9'800) << "what is off by far costs its sample";
  EXPECT_EQ(restarted, 0);
}

TEST_F(SampleTimeTest, ADeviceThatSamplesAsItLikesIsBelieved) {
  std::mt19937 random(1);
  int used = 0;
  for (int i = 0; i < 1000; ++i) {
    interval_ = 20 + static_cast<std::int64_t>(random() % 400);
    used += next().verdict == Verdict::kContinues;
  }
  EXPECT_GT(used, 950);
}

}  // namespace
}  // namespace curbstone::imu::device
