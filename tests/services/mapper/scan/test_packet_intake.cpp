#include "services/mapper/scan/packet_intake.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/resend/message_keeper.hpp"
#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using test::kStart;
constexpr std::int64_t kStep = 1333;  // us

lidar_points_t packet(std::int32_t number) {
  lidar_points_t m;
  m.utime = kStart + kStep * number;
  m.packet = number;
  m.num_points = 0;
  return m;
}

class PacketIntakeTest : public ::testing::Test {
 protected:
  PacketIntakeTest() {
    bus_.subscribe<resend_request_t>(kResendRequests, [this](const resend_request_t& m) {
      requests_.push_back(m);
      if (driver_answers_) keeper_.request(m);
    });
    bus_.subscribe<lidar_points_t>(resent_channel("LIDAR_POINTS"), [this](const lidar_points_t& m) {
      if (again_is_lost_-- > 0) return;
      intake_.add_resent(m, handler_);
    });
  }
  /// The driver sends the packet; the listener hears it or not.
  void send(std::int32_t number, bool is_heard = true) {
    keeper_.keep(packet(number));
    if (is_heard) intake_.add(packet(number), handler_);
    if (number % 15 == 14) tick();
  }
  void send_all(std::int32_t from, std::int32_t to, bool are_heard = true) {
    for (std::int32_t i = from; i < to; ++i) send(i, are_heard);
  }
  void tick() {
    now_ += 20'000;
    keeper_.tick();
    intake_.tick(now_, handler_);
    bus_.dispatch();
  }
  void expect_all(std::int32_t from, std::int32_t to) const {
    std::vector<std::int32_t> all(static_cast<std::size_t>(to - from));
    std::iota(all.begin(), all.end(), from);
    EXPECT_EQ(handed_on_, all);
  }

  LocalBus bus_;
  MessageKeeper keeper_{bus_, "LIDAR_POINTS"};
  PacketIntake intake_{bus_, "mapper", "LIDAR_POINTS"};
  bool driver_answers_ = true;
  int again_is_lost_ = 0;
  std::int64_t now_ = kStart;
  std::vector<resend_request_t> requests_;
  std::vector<std::int32_t> handed_on_;
  PacketIntake::Handler handler_ = [this](const lidar_points_t& m) { handed_on_.push_back(m.packet); };
};

/// A replay ticks each 0.25 s of message time, or each second, and nobody answers: 50 such ticks were 12 s, of which
/// all but 4 s went without a word.
TEST_F(PacketIntakeTest, LosesNothingButWhatIsLostWhereTicksAreFarApart) {
  for (const int each : {188, 750}) {  // packets of 1/750 s
    PacketIntake intake(bus_, "mapper", "LIDAR_POINTS");
    handed_on_.clear();
    for (int i = 0; i < 30'000; ++i) {
      if (i != 7'000) intake.add(packet(i), handler_);
      if (i % each == 0) intake.tick(packet(i).utime, handler_);
    }
    intake.release(handler_);
    EXPECT_EQ(handed_on_.size(), 29'999U) << each;
    EXPECT_EQ(intake.counters().values().at("lidar.not_resent"), 1);
  }
}

TEST_F(PacketIntakeTest, HandsOnAtOnceWhatIsInOrder) {
  for (int i = 0; i < 100; ++i) {
    send(i);
    EXPECT_THAT(handed_on_, SizeIs(static_cast<std::size_t>(i) + 1));
  }
  EXPECT_THAT(requests_, IsEmpty());
}

TEST_F(PacketIntakeTest, HandsOnInOrderWhatWasLostForSeconds) {
  send_all(0, 750);
  send_all(750, 3600, false);  // 3.8 s: the process was stopped
  send_all(3600, 9000);
  expect_all(0, 9000);
  EXPECT_EQ(intake_.counters()["lidar.resent"], 2850);
  EXPECT_LT(requests_.size(), 3U);
}

TEST_F(PacketIntakeTest, IsUpToDateAgainWithinTheTimeThatWasLost) {
  send_all(0, 750);
  send_all(750, 3600, false);
  send_all(3600, 6450);
  EXPECT_EQ(handed_on_.back(), 6449);
}

TEST_F(PacketIntakeTest, HandsOnInOrderWhenWhatIsSentAgainIsLostToo) {
  send_all(0, 100);
  send_all(100, 400, false);
  again_is_lost_ = 37;
  send_all(400, 3000);
  expect_all(0, 3000);
}

TEST_F(PacketIntakeTest, HandsOnInOrderOnABusThatLosesEachTenth) {
  for (int i = 0; i < 5000; ++i) {
    if (i % 397 == 0) again_is_lost_ = 1;
    send(i, i % 10 != 3 || i > 4000);
  }
  expect_all(0, 5000);
}

TEST_F(PacketIntakeTest, GoesOnAfterASecondWithoutWhatCannotBeHad) {
  driver_answers_ = false;
  send_all(0, 100);
  send_all(100, 110, false);
  send_all(110, 110 + 740);
  EXPECT_EQ(handed_on_.back(), 99) << "not a second yet";
  send_all(850, 900);
  EXPECT_EQ(handed_on_.back(), 899);
  EXPECT_THAT(handed_on_, SizeIs(890));
  EXPECT_EQ(intake_.counters()["lidar.not_resent"], 1);
}

TEST_F(PacketIntakeTest, IsPatientWhenSecondsLieInItsQueue) {
  send_all(0, 750);
  send_all(750, 3600, false);
  for (std::int32_t i = 3600; i < 5000; ++i) {  // without a tick
    keeper_.keep(packet(i));
    intake_.add(packet(i), handler_);
  }
  send_all(5000, 9000);
  expect_all(0, 9000);
}

TEST_F(PacketIntakeTest, NoLongerWaitsForADriverThatNeverAnswers) {
  driver_answers_ = false;
  std::int32_t i = 0;
  for (; i < 4000; ++i) send(i, i % 900 != 5);
  EXPECT_EQ(intake_.counters()["lidar.not_resent"], 3);
  for (; i < 8000; ++i) {
    send(i, i % 100 != 5);
    if (i % 100 == 6) {
      EXPECT_EQ(handed_on_.back(), i);
    }
  }
}

TEST_F(PacketIntakeTest, AStopLongerThanTheDriverKeepsIsHealedAsFarAsItCanBe) {
  MessageKeeper short_memory(bus_, "LIDAR_POINTS", {2'000'000, 1U << 20});
  driver_answers_ = false;
  bus_.subscribe<resend_request_t>(kResendRequests, [&](const resend_request_t& m) { short_memory.request(m); });
  for (int i = 0; i < 12'000; ++i) {
    short_memory.keep(packet(i));
    if (i < 100 || i >= 4000) intake_.add(packet(i), handler_);
    if (i % 15 != 14) continue;
    short_memory.tick();
    tick();
  }
  EXPECT_EQ(handed_on_.back(), 11'999);
  EXPECT_TRUE(std::is_sorted(handed_on_.begin(), handed_on_.end()));
  EXPECT_GT(handed_on_.size(), 100U + 8000 + 600) << "of 2 s, while the held live ones fill the bound";
}

TEST_F(PacketIntakeTest, HandsOnWhatItHoldsWhenTheDriverBeginsAnew) {
  driver_answers_ = false;
  send_all(0, 100);
  send_all(100, 110, false);
  send_all(110, 120);
  lidar_points_t first = packet(120 + 1 + static_cast<std::int32_t>(PacketIntake::kRestart / kStep));
  first.packet = 0;
  intake_.add(first, handler_);
  EXPECT_THAT(handed_on_, SizeIs(111));
  EXPECT_EQ(handed_on_.back(), 0);
}

TEST_F(PacketIntakeTest, HandsOnDuplicatesForTheCounters) {
  send_all(0, 3);
  intake_.add(packet(1), handler_);
  EXPECT_THAT(handed_on_, ElementsAre(0, 1, 2, 1));
  intake_.add_resent(packet(1), handler_);
  EXPECT_THAT(handed_on_, SizeIs(4)) << "what was sent again for another";
}

TEST_F(PacketIntakeTest, ASuccessorBeginsWhereItsPredecessorEnded) {
  send_all(0, 1500, false);
  intake_.begin_at(packet(700).utime);
  send_all(1500, 4000);
  expect_all(700, 4000);
}

TEST_F(PacketIntakeTest, HoldsNoMoreThanItsBoundAndLosesNothing) {
  send_all(0, 100);
  send_all(100, 200, false);
  driver_answers_ = false;
  for (std::int32_t i = 200; i < 800; ++i) send(i);
  driver_answers_ = true;
  send_all(800, 5000);
  expect_all(0, 5000);
}

TEST_F(PacketIntakeTest, ReleasesWhatItHoldsAtTheEnd) {
  driver_answers_ = false;
  send_all(0, 100);
  send_all(105, 110);
  intake_.release(handler_);
  EXPECT_THAT(handed_on_, SizeIs(105));
}

TEST_F(PacketIntakeTest, AnyNumbersAndStampsAreSurvived) {
  unsigned state = 1;
  const auto next = [&] { return state = state * 1664525U + 1013904223U; };
  for (int i = 0; i < 20'000; ++i) {
    lidar_points_t m = packet(static_cast<std::int32_t>(next() % 64));
    if (next() % 8 == 0) m.packet = static_cast<std::int32_t>(next());
    if (next() % 8 == 0) m.utime = static_cast<std::int64_t>(std::uint64_t{next()} << 32 | next());
    if (next() % 2 == 0)
      intake_.add(m, handler_);
    else
      intake_.add_resent(m, handler_);
    if (i % 15 == 0) intake_.tick(static_cast<std::int64_t>(next()), handler_);
  }
  intake_.release(handler_);
  EXPECT_GT(handed_on_.size(), 5000U);
}

TEST_F(PacketIntakeTest, ADriverThatRestartsAtOnceIsNoSecondLidar) {
  for (const std::int32_t pause : {1, 5, 20, 36}) {  // packets
    PacketIntake intake(bus_, "mapper", "LIDAR_POINTS");
    int passed = 0;
    const auto count = [&](const lidar_points_t&) { ++passed; };
    for (std::int32_t i = 0; i < 2'000; ++i) {
      if (i >= 1'000 && i < 1'000 + pause) continue;
      lidar_points_t m = packet(i);
      if (i >= 1'000) m.packet -= 1'000 + pause;
      intake.add(m, count);
      if (i % 15 == 0) intake.tick(kStart + i * kStep, count);
      std::vector<std::string> faults;
      intake.add_faults(faults);
      EXPECT_THAT(faults, SizeIs(0)) << i;
    }
    EXPECT_GE(passed, 2'000 - 1 - PacketIntake::kRestart / kStep) << pause;
  }
}

TEST_F(PacketIntakeTest, OfTwoLidarsOnOneChannelOneIsHandedOnAndBothAreNamed) {
  for (const std::int32_t other : {-1'000, 50'000, 500'000}) {  // how far the second one's numbers are apart
    PacketIntake intake(bus_, "mapper", "LIDAR_POINTS");
    std::vector<std::int32_t> from_first, from_second;
    const auto handler = [&](const lidar_points_t& m) {
      (m.packet % 10'000 < 5'000 ? from_first : from_second).push_back(m.packet);
    };
    for (std::int32_t i = 1'000; i < 4'000; ++i) {
      lidar_points_t m = packet(i);
      intake.add(m, handler);
      if (i >= 2'000 && i < 3'000) {
        m.packet += other + 5'000;
        m.utime += 400;
        intake.add(m, handler);
      }
      if (i % 15 == 0) intake.tick(kStart + i * kStep, handler);
      std::vector<std::string> faults;
      intake.add_faults(faults);
      if (i > 2'100 && i < 3'000) {
        EXPECT_THAT(faults, SizeIs(1)) << i;
      }
    }
    EXPECT_TRUE(from_first.size() >= 2'990U || from_second.size() >= 900U) << "one of them, whole: " << other;
    EXPECT_GE(intake.counters()["refused.second_lidar"], 900) << other;
    std::vector<std::string> faults;
    intake.add_faults(faults);
    EXPECT_THAT(faults, IsEmpty()) << "a second later";
  }
}

/// lcm-logplayer with a log of the same LiDAR, on a busy host: its packets come in bursts.
TEST_F(PacketIntakeTest, ALogThatIsPlayedIntoTheBusChangesNothingAndIsNamed) {
  for (const std::int32_t other : {-1'000, 50'000, 3'000}) {
    PacketIntake intake(bus_, "mapper", "LIDAR_POINTS");
    std::vector<std::int32_t> passed;
    const auto handler = [&](const lidar_points_t& m) { passed.push_back(m.packet); };
    for (std::int32_t i = 1'000; i < 4'000; ++i) {
      intake.add(packet(i), handler);
      for (std::int32_t k = i - 100; i % 100 == 0 && i > 2'000 && k < i; ++k) {
        lidar_points_t old = packet(k);
        old.packet += other;
        old.utime -= 3'600'000'000;
        intake.add(old, handler);
      }
      if (i % 15 == 0) intake.tick(kStart + i * kStep, handler);
    }
    EXPECT_THAT(passed, SizeIs(3'000)) << other;
    EXPECT_TRUE(std::is_sorted(passed.begin(), passed.end()));
    std::vector<std::string> faults;
    intake.add_faults(faults);
    EXPECT_THAT(faults, SizeIs(1)) << other;
  }
}

TEST_F(PacketIntakeTest, ADriverThatRestartsWhileTheClockIsSetBackIsSoonUsed) {
  PacketIntake intake(bus_, "mapper", "LIDAR_POINTS");
  int passed = 0;
  const auto handler = [&](const lidar_points_t&) { ++passed; };
  for (std::int32_t i = 1'000; i < 2'000; ++i) intake.add(packet(i), handler);
  for (std::int32_t i = 0; i < 1'000; ++i) {
    lidar_points_t m = packet(i);
    m.utime -= 3'600'000'000;
    intake.add(m, handler);
  }
  EXPECT_EQ(passed, 2'000 - (PacketIntake::kClockWasSet - 1));
}

}  // namespace
}  // namespace curbstone::mapper::scan
