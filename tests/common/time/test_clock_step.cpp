#include "common/time/clock_step.hpp"

#include <gtest/gtest.h>

#include "tests/stamps.hpp"

namespace curbstone {
namespace {

using test::kSecond;
constexpr std::int64_t kWall = 1'700'000'000 * kSecond;  // us, when the steady clock stands at 0

/// Reads once a second, as a service does.
class Host {
 public:
  void run(int seconds, std::int64_t slewed_each = 0) {
    for (int k = 0; k < seconds; ++k) {
      steady_ += kSecond;
      offset_ += slewed_each;
      clock.read(steady_ - 3, kWall + steady_ + offset_, steady_);
    }
  }
  void set_by(std::int64_t us) { offset_ += us; }
  void read_slowly(std::int64_t took) { clock.read(steady_, kWall + steady_ + offset_, steady_ + took); }

  ClockStep clock;

 private:
  std::int64_t steady_ = 5 * kSecond;
  std::int64_t offset_ = 0;
};

TEST(ClockStep, AClockThatRunsOnHasNone) {
  Host host;
  host.run(100);
  EXPECT_EQ(host.clock.steps(), 0);
  EXPECT_FALSE(host.clock.recent());
}

TEST(ClockStep, AClockThatIsSetIsReportedForAMinute) {
  Host host;
  host.run(3);
  host.set_by(-312'000);
  host.run(1);
  EXPECT_EQ(host.clock.recent(), -312'000);
  host.run(59);
  EXPECT_EQ(host.clock.recent(), -312'000);
  host.run(1);
  EXPECT_FALSE(host.clock.recent());
  EXPECT_EQ(host.clock.steps(), 1);
}

TEST(ClockStep, ASlewIsNoStepHoweverFarItGoes) {
  Host host;
  host.run(1000, 500);  // 500 ppm, adjtimex's limit
  EXPECT_EQ(host.clock.steps(), 0);
  host.set_by(49'000);
  host.run(5);
  EXPECT_EQ(host.clock.steps(), 0);
}

TEST(ClockStep, AProcessThatHadToWaitWhileItReadIsNoStep) {
  Host host;
  host.run(3);
  host.read_slowly(400'000);
  host.run(3);
  EXPECT_EQ(host.clock.steps(), 0);
}

}  // namespace
}  // namespace curbstone
