#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstring>
#include <curbstone/odometry_t.hpp>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/resend/message_keeper.hpp"
#include "common/resend/resend_client.hpp"

namespace curbstone {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kBegin = 1'700'000'000'000'000;
constexpr std::int64_t kStep = 10'000;

odometry_t sample(int i) {
  odometry_t message{};
  message.utime = kBegin + i * kStep;
  message.position[0] = i;
  return message;
}

class ResendTest : public ::testing::Test {
 protected:
  ResendTest() {
    bus_.subscribe<resend_request_t>(kResendRequests, [this](const resend_request_t& m) {
      ++requests_;
      if (keeper_answers_) keeper_.request(m);
    });
    bus_.subscribe<odometry_t>(resent_channel("ODOMETRY"),
                               [this](const odometry_t& m) { came_.push_back(m.position[0]); });
  }
  void keep(int from, int to) {
    for (int i = from; i < to; ++i) keeper_.keep(sample(i));
  }
  [[nodiscard]] static resend_request_t wanted(int after, int before, const std::string& who = "mapper") {
    resend_request_t request;
    request.requester = who;
    request.channel = "ODOMETRY";
    request.after = sample(after).utime;
    request.before = sample(before).utime;
    return request;
  }

  LocalBus bus_;
  MessageKeeper keeper_{bus_, "ODOMETRY", {1'000'000, 60'000}};  // 1 s; 100 samples are 58,400 bytes
  bool keeper_answers_ = true;
  int requests_ = 0;
  std::vector<double> came_;
};

TEST_F(ResendTest, WhatWasLostComesAgainInOrder) {
  keep(0, 20);
  keeper_.request(wanted(4, 8));
  bus_.dispatch();
  EXPECT_THAT(came_, ElementsAre(5, 6, 7));
  EXPECT_EQ(keeper_.resent(), 3);
}

TEST_F(ResendTest, NothingIsSentThatNobodyAskedFor) {
  keep(0, 20);
  resend_request_t other = wanted(0, 20);
  other.channel = "LIDAR_POINTS";
  keeper_.request(other);
  keeper_.request(wanted(8, 4));
  keeper_.tick();
  bus_.dispatch();
  EXPECT_THAT(came_, IsEmpty());
}

TEST_F(ResendTest, NoMoreIsSentATickThanAStockSocketBufferBears) {
  keep(0, 90);
  keeper_.request(wanted(0, 90));
  bus_.dispatch();
  EXPECT_THAT(came_, SizeIs(MessageKeeper::kAtOnce));
  keeper_.request(wanted(29, 90));
  bus_.dispatch();
  EXPECT_THAT(came_, SizeIs(MessageKeeper::kAtOnce)) << "asking more often brings no more";
  for (int i = 0; i < 3; ++i) keeper_.tick();
  bus_.dispatch();
  EXPECT_THAT(came_, SizeIs(30 + 60));
  EXPECT_EQ(came_.back(), 89);
}

TEST_F(ResendTest, ListenersTakeTurns) {
  keep(0, 90);
  keeper_.request(wanted(0, 90, "mapper"));
  keeper_.request(wanted(49, 90, "localizer"));
  keeper_.tick();
  bus_.dispatch();
  EXPECT_EQ(std::count_if(came_.begin() + 30, came_.end(), [](double i) { return i >= 50; }), 15);
}

TEST_F(ResendTest, NoMoreListenersAreAnsweredThanTheBound) {
  keep(0, 90);
  for (int i = 0; i < 100; ++i) keeper_.request(wanted(0, 90, std::to_string(i)));
  for (int i = 0; i < 1000; ++i) keeper_.tick();
  bus_.dispatch();
  EXPECT_EQ(came_.size(), MessageKeeper::kMaxListeners * 89);
}

TEST_F(ResendTest, OnlyTheNewestSecondsAndBytesAreKept) {
  keep(0, 1000);
  keeper_.request(wanted(0, 1000));
  for (int i = 0; i < 10; ++i) keeper_.tick();
  bus_.dispatch();
  EXPECT_GE(came_.front(), 898);
  EXPECT_EQ(came_.back(), 999);
}

/// Of a LiDAR: no two packets are alike in size.
struct Packet {
  std::int64_t utime;
  [[nodiscard]] int getEncodedSize() const { return 5000 + static_cast<int>(utime / kStep * 37 % 1000); }
  int encode(void* to, int /*offset*/, int size) const {
    std::memset(to, 1, static_cast<std::size_t>(size));
    return size;
  }
};

TEST(MessageKeeper, TakesHardlyMoreMemoryThanItsMessages) {
  constexpr std::size_t kBytes = 4'000'000;
  LocalBus bus;
  MessageKeeper keeper(bus, "LIDAR_POINTS", {std::int64_t{1} << 60, kBytes});
  const std::size_t before = mallinfo2().uordblks;
  for (int i = 0; i < 20'000; ++i) keeper.keep(Packet{kBegin + i * kStep});
  EXPECT_LT(mallinfo2().uordblks - before, kBytes + kBytes / 4);
}

TEST_F(ResendTest, AClockThatIsSetBackBeginsAnew) {
  keep(500, 520);
  keep(0, 10);
  keeper_.request(wanted(-1, 600));
  bus_.dispatch();
  EXPECT_THAT(came_, SizeIs(10));
  EXPECT_EQ(came_.back(), 9);
}

TEST_F(ResendTest, AsksAgainOnlyWhileNothingComes) {
  ResendClient client(bus_, "mapper", "ODOMETRY");
  keeper_answers_ = false;
  std::int64_t now = kBegin;
  for (int i = 0; i < 50; ++i, now += 20'000) client.ask(now, MissingMessages{kBegin, kBegin + 1000});
  bus_.dispatch();
  EXPECT_EQ(requests_, 5) << "each 0.2 s";
  for (int i = 0; i < 50; ++i, now += 20'000) client.ask(now, MissingMessages{kBegin + i, kBegin + 1000});
  bus_.dispatch();
  EXPECT_LE(requests_, 6) << "it is coming";
  client.ask(now, MissingMessages{kBegin + 2000, kBegin + 3000});
  bus_.dispatch();
  EXPECT_LE(requests_, 7) << "another loss: at once";
}

TEST_F(ResendTest, IsDeafForAMinuteToASenderThatNeverAnswers) {
  ResendClient client(bus_, "mapper", "ODOMETRY");
  client.gave_up(kBegin);
  client.gave_up(kBegin);
  EXPECT_FALSE(client.is_deaf(kBegin));
  client.answered();
  for (int i = 0; i < 3; ++i) client.gave_up(kBegin);
  EXPECT_TRUE(client.is_deaf(kBegin + 59'000'000));
  EXPECT_FALSE(client.is_deaf(kBegin + 61'000'000));
  EXPECT_FALSE(client.is_deaf(kBegin - 1)) << "the clock was set back";
}

}  // namespace
}  // namespace curbstone
