#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/time/clock_offset.hpp"

namespace curbstone {
namespace {

constexpr std::int64_t kHostStart = 1'700'000'000'000'000;

TEST(ClockOffset, FindsTheOffsetOfTheLeastDelayedSample) {
  ClockOffset clock;
  EXPECT_EQ(clock.to_host(1000, kHostStart + 1000 + 700), kHostStart + 1700);  // all that is known yet
  EXPECT_EQ(clock.to_host(2000, kHostStart + 2000 + 90), kHostStart + 2090);
  EXPECT_EQ(clock.to_host(3000, kHostStart + 3000 + 4000), kHostStart + 3090);  // late: corrected
}

TEST(ClockOffset, IsNeverLaterThanTheReceipt) {
  ClockOffset clock;
  std::mt19937 random(1);
  for (std::int64_t stamp = 0; stamp < 60'000'000; stamp += 1333) {
    const std::int64_t received = kHostStart + stamp + 100 + static_cast<std::int64_t>(random() % 5000);
    EXPECT_LE(clock.to_host(stamp, received), received);
  }
}

TEST(ClockOffset, FollowsADriftingClockWithinItsWindow) {
  for (const double ppm : {-50.0, 50.0}) {
    ClockOffset clock;
    std::mt19937 random(1);
    for (std::int64_t t = 0; t < 600'000'000; t += 10'000) {
      const auto stamp = static_cast<std::int64_t>(static_cast<double>(t) * (1.0 + ppm * 1e-6));
      const std::int64_t delay = 50 + static_cast<std::int64_t>(random() % 2000);
      const std::int64_t error = clock.to_host(stamp, kHostStart + t + delay) - (kHostStart + t);
      EXPECT_LE(std::abs(error), t < 1'000'000 ? 2050 : 50 + 250 + 100) << "at " << t << " us, " << ppm << " ppm";
    }
  }
}

/// More than a crystal: its GPS or PTP is not what it should be, or the host's clock is being set.
TEST(ClockOffset, ForeseesAClockThatDriftsEvenly) {
  for (const double part : {-0.01, -0.001, -0.0002, 0.0002, 0.001, 0.01}) {
    ClockOffset clock;
    std::mt19937 random(1);
    for (std::int64_t t = 0; t < 120'000'000; t += 1333) {
      const auto stamp = static_cast<std::int64_t>(static_cast<double>(t) * (1.0 - part));
      const std::int64_t delay = 50 + static_cast<std::int64_t>(random() % 2000);
      const std::int64_t error = clock.to_host(stamp, kHostStart + t + delay) - (kHostStart + t);
      if (t < 6'000'000) continue;
      ASSERT_NEAR(static_cast<double>(error), 50, part < -0.001 ? 800 : 220) << "at " << t << " us, " << part;
      ASSERT_NEAR(clock.drift().drift(), part, 5e-5 + 0.02 * std::abs(part)) << "at " << t << " us";
    }
  }
}

/// What is slow for seconds and catches up is the host, and not the device's clock.
TEST(ClockOffset, DelaysOfAHostUnderLoadAreNoDrift) {
  ClockOffset clock;
  std::mt19937 random(1);
  std::int64_t least = 0;
  for (std::int64_t t = 0; t < 120'000'000; t += 10'000) {
    if (t % 700'000 == 0) least = static_cast<std::int64_t>(random() % 3000);
    const std::int64_t received = kHostStart + t + 50 + least + static_cast<std::int64_t>(random() % 2000);
    const std::int64_t stamp = clock.to_host(t, received);
    EXPECT_LE(stamp, received);
    EXPECT_NEAR(static_cast<double>(stamp - kHostStart - t), 50, 3000) << "at " << t << " us";
  }
}

TEST(ClockOffset, ADriftThatEndsIsForgotten) {
  ClockOffset clock;
  std::int64_t stamp = 0;
  for (std::int64_t t = 0; t < 60'000'000; t += 10'000) {
    stamp += t < 20'000'000 ? 9'950 : 10'000;
    const std::int64_t received = kHostStart + t + 10'000;
    const std::int64_t error = clock.to_host(stamp, received) - received;
    EXPECT_LE(error, 0);
    if (t > 27'000'000) {
      EXPECT_EQ(error, 0);
    }
  }
  EXPECT_EQ(clock.drift().drift(), 0);
}

TEST(ClockOffset, StartsAnewWhenTheDevicesClockIsSet) {
  ClockOffset clock;
  clock.to_host(5'000'000, kHostStart);
  EXPECT_EQ(clock.to_host(kHostStart - 3'600'000'000, kHostStart + 10'000), kHostStart + 10'000);
  EXPECT_EQ(clock.jumps(), 1);
  EXPECT_EQ(clock.to_host(10, kHostStart + 20'000), kHostStart + 20'000);
  EXPECT_EQ(clock.jumps(), 2);
}

TEST(ClockOffset, ForgetsWhatIsOlderThanItsWindowAfterASilence) {
  ClockOffset clock;
  clock.to_host(0, kHostStart);
  // A minute later the slow clock has lost 6 ms: the offset of a minute ago must not be used.
  EXPECT_EQ(clock.to_host(60'000'000 - 6'000, kHostStart + 60'000'000), kHostStart + 60'000'000);
}

}  // namespace
}  // namespace curbstone
