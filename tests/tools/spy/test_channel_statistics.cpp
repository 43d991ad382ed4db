#include "tools/spy/board/channel_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/stamps.hpp"

namespace curbstone::spy::board {
namespace {

using test::kStart;

TEST(ChannelStatistics, ASteadyChannelHasItsRateAndNoJitter) {
  ChannelStatistics channel;
  std::int64_t now = kStart;
  for (int k = 0; k < 300; ++k) channel.add(now += 10'000, 500, std::nullopt);
  const ChannelRates rates = channel.rates(now);
  EXPECT_DOUBLE_EQ(rates.rate, 100);
  EXPECT_DOUBLE_EQ(rates.bandwidth, 50'000);
  EXPECT_NEAR(rates.jitter, 0, 1e-9);
  EXPECT_EQ(rates.age, 0);
  EXPECT_EQ(channel.messages(), 300);
  EXPECT_FALSE(channel.lost()) << "its messages have no number";
}

TEST(ChannelStatistics, JitterIsTheDeviationOfTheIntervals) {
  ChannelStatistics channel;
  std::int64_t now = kStart;
  channel.add(now, 1, std::nullopt);
  for (int k = 0; k < 100; ++k) channel.add(now += k % 2 == 0 ? 8'000 : 12'000, 1, std::nullopt);
  EXPECT_NEAR(channel.rates(now).jitter, 0.002, 1e-9);
}

TEST(ChannelStatistics, ASilentChannelSlowsDownAndIsForgotten) {
  ChannelStatistics channel;
  std::int64_t now = kStart;
  for (int k = 0; k < 101; ++k) channel.add(now += 10'000, 500, std::nullopt);
  EXPECT_NEAR(channel.rates(now + 1'000'000).rate, 50, 1);
  EXPECT_EQ(channel.rates(now + 1'000'000).age, 1'000'000);
  EXPECT_EQ(channel.rates(now + 6'000'000).rate, 0);
  EXPECT_TRUE(std::isnan(channel.rates(now + 6'000'000).jitter));
}

TEST(ChannelStatistics, OneMessageHasNoRate) {
  ChannelStatistics channel;
  EXPECT_EQ(channel.rates(kStart).rate, 0);
  channel.add(kStart, 7, std::nullopt);
  EXPECT_EQ(channel.rates(kStart).rate, 0);
  EXPECT_EQ(channel.last_size(), 7U);
}

TEST(ChannelStatistics, GapsInTheSequenceAreLosses) {
  ChannelStatistics channel;
  std::int64_t now = kStart;
  for (const int sequence : {10, 11, 14, 15}) channel.add(now += 1000, 1, sequence);
  EXPECT_EQ(channel.lost(), 2);
  channel.add(now += 1000, 1, 3);
  EXPECT_EQ(channel.lost(), 2) << "the sender was restarted";
  channel.add(now += 1000, 1, 3'000'000'000);
  EXPECT_EQ(channel.lost(), 2) << "and again";
}

TEST(ChannelStatistics, AFloodOfMessagesTakesBoundedMemoryAndIsMeasured) {
  ChannelStatistics channel;
  std::int64_t now = kStart;
  for (int k = 0; k < 100'000; ++k) channel.add(now += 10, 1, std::nullopt);
  EXPECT_NEAR(channel.rates(now).rate, 100'000, 1);
}

}  // namespace
}  // namespace curbstone::spy::board
