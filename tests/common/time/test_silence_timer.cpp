#include "common/time/silence_timer.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

constexpr std::int64_t kTick = 20'000;  // us

struct Listener {
  SilenceTimer timer;
  std::int64_t now = 1'700'000'000'000'000;
  void run(double seconds) {
    for (std::int64_t left = std::int64_t(seconds * 1e6); left > 0; left -= kTick) timer.tick(now += kTick);
  }
};

TEST(SilenceTimer, CountsSinceTheLastMessage) {
  Listener listener;
  listener.run(0.5);
  listener.timer.heard();
  EXPECT_EQ(listener.timer.silent(), 0);
  listener.run(1.5);
  EXPECT_EQ(listener.timer.silent(), 1'500'000) << "silence is named in time";
  EXPECT_TRUE(listener.timer.was_heard());
}

TEST(SilenceTimer, CountsFromTheWakeUpOfAListenerThatWasStopped) {
  Listener listener;
  listener.run(1);
  listener.timer.heard();
  listener.now += 5'000'000;
  listener.run(0.02);
  EXPECT_LE(listener.timer.silent(), SilenceTimer::kMaxPerTick);
  listener.run(1);
  EXPECT_GE(listener.timer.silent(), 1'000'000) << "a sender that is silent afterwards is named";
}

TEST(SilenceTimer, IgnoresAClockThatIsSetBack) {
  Listener listener;
  listener.run(0.1);
  listener.timer.heard();
  listener.now -= 3'600'000'000;
  listener.run(1);
  EXPECT_GE(listener.timer.silent(), 900'000);
  EXPECT_LE(listener.timer.silent(), 1'000'000);
}

TEST(SilenceTimer, GivesASenderThatIsStartedTooTimeToSpeak) {
  Listener listener;
  EXPECT_FALSE(listener.timer.never_came());
  listener.run(1.9);
  EXPECT_FALSE(listener.timer.never_came());
  listener.run(0.2);
  EXPECT_TRUE(listener.timer.never_came());
  listener.timer.heard();
  EXPECT_FALSE(listener.timer.never_came());
}

}  // namespace
}  // namespace curbstone
