#include "common/bus/single_sender.hpp"

#include <gtest/gtest.h>

#include "common/bus/sequence_number.hpp"

namespace curbstone {
namespace {

constexpr std::int64_t kBegin = 1'750'000'000'000'000;  // us
constexpr std::int64_t kPeriod = 10'000;                // us

/// A sender of a message each 10 ms.
struct Sender {
  std::int64_t utime = kBegin;
  std::int32_t number = 0;
  void skip(int messages) {
    utime += messages * kPeriod;
    number = next_sequence_number(number, messages);
  }
};

int accepted(SingleSender& channel, Sender& sender, int messages) {
  int count = 0;
  for (int i = 0; i < messages; ++i) {
    count += channel.accept(sender.utime, sender.number);
    sender.skip(1);
  }
  return count;
}

TEST(SingleSender, AllMessagesOfOneSenderAreUsed) {
  SingleSender channel;
  Sender sender;
  EXPECT_EQ(accepted(channel, sender, 1000), 1000);
  EXPECT_FALSE(channel.two_send());
}

TEST(SingleSender, LostLateAndDoubledMessagesAreTheSendersOwn) {
  SingleSender channel;
  Sender sender;
  EXPECT_EQ(accepted(channel, sender, 100), 100);
  sender.skip(3);
  EXPECT_EQ(accepted(channel, sender, 10), 10);
  Sender late = {sender.utime - 12 * kPeriod, sender.number - 12};
  EXPECT_EQ(accepted(channel, late, 2), 2);
  Sender twice = {sender.utime - kPeriod, sender.number - 1};
  EXPECT_EQ(accepted(channel, twice, 1), 1);
  sender.skip(6000);  // the receiver was stopped for a minute
  EXPECT_EQ(accepted(channel, sender, 10), 10);
  EXPECT_FALSE(channel.two_send());
}

TEST(SingleSender, JitteredStampsAreTheSendersOwn) {
  SingleSender channel;
  // A millisecond a packet, one stamp for 50 of them, each tenth lost.
  for (int i = 0; i < 1000; ++i) {
    if (i % 10 == 7) continue;
    EXPECT_TRUE(channel.accept(kBegin + i / 50 * 50'000, i)) << i;
  }
  channel = SingleSender();
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(channel.accept(kBegin + (i + (i % 3) * 3) * kPeriod, i)) << i;
  EXPECT_FALSE(channel.two_send());
}

TEST(SingleSender, MessagesWithoutNumbersAreAllUsed) {
  SingleSender channel;
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(channel.accept(kBegin + i * kPeriod, 0)) << i;
  EXPECT_FALSE(channel.two_send());
}

TEST(SingleSender, AClockThatIsSetChangesNoSender) {
  for (const std::int64_t step : {-3'600'000'000LL, -2'000'000LL, 500'000LL, 2'000'000LL, 250'000'000'000'000LL}) {
    SingleSender channel;
    Sender sender;
    EXPECT_EQ(accepted(channel, sender, 100), 100);
    sender.utime += step;
    EXPECT_EQ(accepted(channel, sender, 100), 100) << step;
    EXPECT_FALSE(channel.two_send());
  }
}

TEST(SingleSender, ADriverThatWasStartedAgainIsUsedAtOnce) {
  for (const std::int32_t number : {0, 95, 1'000'000}) {
    SingleSender channel;
    Sender sender{kBegin, 1000};
    EXPECT_EQ(accepted(channel, sender, 100), 100);
    Sender again = {sender.utime + 300'000, number};
    EXPECT_EQ(accepted(channel, again, 100), 100) << number;
    EXPECT_FALSE(channel.two_send());
  }
}

TEST(SingleSender, ADriverThatWasStartedAgainWithAnotherClockIsUsedSoon) {
  SingleSender channel;
  Sender sender{kBegin, 1000};
  EXPECT_EQ(accepted(channel, sender, 100), 100);
  Sender again = {sender.utime - 3'600'000'000, 0};
  EXPECT_EQ(accepted(channel, again, 100), 100 - (SingleSender::kGone - 1));
  EXPECT_FALSE(channel.two_send());
}

TEST(SingleSender, NumbersGoOnAtZero) {
  SingleSender channel;
  Sender sender{kBegin, 0x7FFFFFFF - 9};
  EXPECT_EQ(accepted(channel, sender, 20), 20);
  EXPECT_EQ(sender.number, 10);
}

struct Other {
  const char* name;
  std::int64_t later;    // us, than the first sender's stamps
  std::int32_t numbers;  // ahead of the first sender's
};

class SecondSender : public testing::TestWithParam<Other> {};

/// The bus brings the messages of a busy host in bursts.
TEST_P(SecondSender, IsRefusedAndTold) {
  for (const int burst : {1, 3, 10}) {
    SingleSender channel;
    Sender first{kBegin, 5000};
    EXPECT_EQ(accepted(channel, first, 100), 100);
    Sender second = {first.utime + GetParam().later, first.number + GetParam().numbers};
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(accepted(channel, first, burst), burst) << burst << ", " << i;
      EXPECT_EQ(accepted(channel, second, burst), 0) << burst << ", " << i;
    }
    EXPECT_TRUE(channel.two_send());
    EXPECT_EQ(accepted(channel, first, 200), 200);
    EXPECT_FALSE(channel.two_send());
  }
}

INSTANTIATE_TEST_SUITE_P(ByItsNumbersAndStamps, SecondSender,
                         testing::Values(Other{"StartedLater", 3'000, -4000}, Other{"StartedEarlier", 3'000, 7000},
                                         Other{"StartedSoonAfter", 3'000, -30},
                                         Other{"LogOfAnHourAgo", -3'600'000'000, -4000},
                                         Other{"LogWithLikeNumbers", -3'600'000'000, -100},
                                         Other{"LogFromTheFuture", 3'600'000'000, 30}),
                         [](const auto& i) { return i.param.name; });

TEST(SingleSender, AStrayMessageIsNoSecondSender) {
  SingleSender channel;
  Sender sender{kBegin, 5000};
  EXPECT_EQ(accepted(channel, sender, 100), 100);
  EXPECT_FALSE(channel.accept(sender.utime, 77));
  EXPECT_EQ(accepted(channel, sender, 100), 100);
  EXPECT_FALSE(channel.two_send());
}

}  // namespace
}  // namespace curbstone
