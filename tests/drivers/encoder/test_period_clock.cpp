#include "drivers/encoder/period_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "common/time/settling_start.hpp"
#include "drivers/encoder/wheel_counter.hpp"

namespace curbstone::encoder {
namespace {

constexpr std::int64_t kPeriod = 10'000;  // us
const PeriodClock::Evidence kNone = [](int, int) -> std::optional<int> { return {}; };

/// Feeds arrivals to a clock and collects what it decides, in order of arrival.
struct Line {
  PeriodClock clock{kPeriod};
  std::vector<PeriodClock::Stamp> stamps;

  void arrive(std::int64_t received, const PeriodClock::Evidence& evidence = kNone) {
    for (const auto& stamp : clock.stamp(received, evidence)) stamps.push_back(stamp);
  }
  [[nodiscard]] int lost() const {
    int lost = 0;
    for (const auto& stamp : stamps) lost += stamp.lost;
    return lost;
  }
  [[nodiscard]] int unsure() const {
    return static_cast<int>(std::count_if(stamps.begin(), stamps.end(), [](const auto& s) { return !s.sure; }));
  }
};

TEST(PeriodClockTest, StampsKeepThePeriodWhateverTheDelay) {
  Line line;
  for (const std::int64_t received : {0, 10'000, 57'000, 57'000, 57'000, 57'000, 61'000, 70'000}) line.arrive(received);
  ASSERT_EQ(line.stamps.size(), 8u);
  EXPECT_TRUE(line.stamps[0].restarted);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(line.stamps[static_cast<std::size_t>(i)].utime, i * kPeriod);
}

TEST(PeriodClockTest, ALateFirstSampleIsShownInHindsightToHaveBeenTakenEarlier) {
  Line line;
  for (const std::int64_t received : {25'000, 25'000, 25'000, 30'100, 41'000}) line.arrive(received);
  ASSERT_EQ(line.stamps.size(), 5u);
  EXPECT_EQ(line.stamps[0].utime, 25'000);  // taken at 0
  EXPECT_EQ(line.stamps[1].earlier, 10'000);
  EXPECT_EQ(line.stamps[2].earlier, 10'000);
  EXPECT_EQ(line.stamps[3].utime, 30'100);
  EXPECT_EQ(line.stamps[3].earlier, 4'900);
  EXPECT_EQ(line.stamps[4].earlier, 0);
}

TEST(PeriodClockTest, LostSamplesAreSkippedWhenTwoSamplesTellTheSame) {
  Line line;
  line.arrive(0);
  line.arrive(40'300, [](int least, int) { return least + 3; });
  EXPECT_EQ(line.stamps.size(), 1u) << "one may be corrupt";
  line.arrive(50'300, [](int least, int) { return least + 3; });
  ASSERT_EQ(line.stamps.size(), 3u);
  EXPECT_EQ(line.stamps[1].steps, 4);
  EXPECT_EQ(line.stamps[1].utime, 40'000);
  EXPECT_EQ(line.stamps[2].utime, 50'000);
}

TEST(PeriodClockTest, ASampleThatTellsOfALossIsNotBelievedAgainstThePunctualOneAfterIt) {
  Line line;
  for (int i = 0; i < 100; ++i) line.arrive(i * kPeriod);
  line.arrive(1'010'000, [](int least, int) { return least + 1; });  // a period late, and corrupt
  line.arrive(1'010'100, [](int least, int) { return least; });
  ASSERT_EQ(line.stamps.size(), 102u);
  EXPECT_EQ(line.stamps[100].utime, 1'000'000);
  EXPECT_EQ(line.stamps[101].utime, 1'010'000);
}

TEST(PeriodClockTest, SamplesThatComeOnThePeriodAfterALossAreStampedTogether) {
  Line line;
  for (int i = 0; i < 600; ++i) {
    if (i == 140 || i == 141) continue;
    line.arrive(i * kPeriod);
    if (i == 180) {
      EXPECT_EQ(line.stamps.size(), 140u);
    }
  }
  EXPECT_EQ(line.lost(), 2);
  EXPECT_EQ(line.unsure(), 1) << "the first one could be a late one before the loss";
  ASSERT_EQ(line.stamps.size(), 598u);
  for (int i = 143; i < 600; ++i) EXPECT_EQ(line.stamps[static_cast<std::size_t>(i - 2)].utime, i * kPeriod);
}

TEST(PeriodClockTest, AHostThatIsLateForASecondHasLostNothing) {
  for (const std::int64_t delay : {8'000, 12'000, 27'000}) {
    Line line;
    std::int64_t arrived = 0;
    for (int i = 0; i < 1000; ++i) {
      arrived = std::max(arrived, i * kPeriod + (i >= 200 && i < 320 ? delay : 200));
      line.arrive(arrived);
    }
    ASSERT_EQ(line.stamps.size(), 1000u);
    EXPECT_EQ(line.unsure(), 0);
    for (int i = 0; i < 1000; ++i) EXPECT_EQ(line.stamps[static_cast<std::size_t>(i)].utime, i * kPeriod + 200);
  }
}

TEST(PeriodClockTest, LatenessThatNothingExplainsIsWithheldAndEndsInANewBeginning) {
  Line line;
  for (int i = 0; i < 600; ++i) line.arrive(i * kPeriod + (i < 200 ? 200 : 15'200));
  EXPECT_EQ(line.unsure(), PeriodClock::kMaxWaiting);
  EXPECT_EQ(line.stamps.back().utime, 5'990'000 + 15'200);
}

TEST(PeriodClockTest, LatenessThatTheEvidenceExplainsIsTheHostsHoweverLongItLasts) {
  Line line;
  for (int i = 0; i < 1000; ++i)
    line.arrive(i * kPeriod + (i < 200 ? 200 : 9'800), [](int least, int) { return least; });
  EXPECT_GE(line.stamps.size(), 999u);
  EXPECT_EQ(line.lost() + line.unsure(), 0);
}

TEST(PeriodClockTest, WhatCameWhileTheHostSleptKeepsItsTime) {
  Line line;
  for (int i = 0; i < 300; ++i)
    line.arrive(i >= 100 && i < 180 ? 1'800'000 : i * kPeriod, [](int least, int) { return least; });
  ASSERT_EQ(line.stamps.size(), 300u);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(line.stamps[static_cast<std::size_t>(i)].utime, i * kPeriod);
}

TEST(PeriodClockTest, ASilenceOrAClockSetBackBeginsAnew) {
  Line line;
  for (const std::int64_t received : {0, 600'000, 5'000, 15'000}) line.arrive(received);
  ASSERT_EQ(line.stamps.size(), 4u);
  EXPECT_EQ(line.stamps[1].utime, 600'000);
  EXPECT_TRUE(line.stamps[2].restarted);
  EXPECT_EQ(line.stamps[3].utime, 15'000);
}

TEST(PeriodClockTest, APauseIsNotAnotherPeriod) {
  Line line;
  for (int i = 0; i < 300; ++i) line.arrive(i >= 46 && i < 64 ? 639'900 + i : i * kPeriod);  // the first block's end
  EXPECT_EQ(line.clock.period(), kPeriod);
  ASSERT_EQ(line.stamps.size(), 300u);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(line.stamps[static_cast<std::size_t>(i)].utime, i * kPeriod);
}

TEST(PeriodClockTest, AnotherPeriodIsNoticed) {
  Line line;
  for (int i = 0; i < 200; ++i) line.arrive(i * 20'000, [](int least, int) { return least; });
  EXPECT_EQ(line.clock.period(), 20'000);
  for (int i = 0; i < 200; ++i) line.arrive(4'000'000 + i * 10'000, [](int least, int) { return least; });
  EXPECT_EQ(line.clock.period(), 10'000);
}

/// A device on a bad bus and a busy host: what it sends, and what WheelCounter and PeriodClock make of it.
class BadBus {
 public:
  struct Chances {
    unsigned lost, corrupt, late, busy;  // in 1000; busy: a second of lateness begins
  };
  BadBus(unsigned seed, const Chances& chances) : random_(seed), chances_(chances) {}

  void drive(int samples, const std::function<double(double)>& speed) {
    double angle = 0;
    for (int i = 0; i < samples; ++i) {
      const std::int64_t taken = i * kPeriod;
      angle += speed(1e-6 * static_cast<double>(taken)) * 1e-6 * static_cast<double>(kPeriod);
      const bool spared = i < 100;
      if (!spared && one_in(chances_.lost)) continue;
      auto counts = static_cast<std::int32_t>(std::floor(angle * 4096 / (2 * std::numbers::pi)));
      if (!spared && one_in(chances_.corrupt)) counts ^= static_cast<std::int32_t>(random_());
      std::int64_t delay = kMinDelay + static_cast<std::int64_t>(random_() % 300);
      if (!spared && one_in(chances_.late)) delay += static_cast<std::int64_t>(random_() % 30'000);
      if (!spared && i > busy_until_ + 200 && one_in(chances_.busy)) {
        busy_until_ = i + 100;
        busy_ = static_cast<std::int64_t>(random_() % 30'000);
      }
      if (i < busy_until_) delay += busy_ + static_cast<std::int64_t>(random_() % 4'000);
      arrived_ = std::max(arrived_, taken + delay);
      receive(taken, {counts, -counts});
    }
  }

  int sent = 0, stamped = 0;
  std::int64_t worst = 0;  // us

 private:
  bool one_in(unsigned chance) { return random_() % 1000 < chance; }
  void receive(std::int64_t taken, const WheelCounter::Raw& counts) {
    ++sent;
    waiting_.push_back({taken, counts});
    const auto evidence = [&](int least, int most) { return odometer_.likely_periods(counts, least, most, 0.01); };
    for (const auto& stamp : clock_.stamp(arrived_, evidence)) {
      const auto [was_taken, had] = waiting_.front();
      waiting_.pop_front();
      if (stamp.restarted) {
        settle_.release([&](Published& published) { judge(published); });
        settle_.begin(arrived_);
      }
      settle_.move_earlier(stamp.earlier);
      if (!stamp.sure) {
        odometer_.skip(0.01 * stamp.steps);
      } else if (odometer_.update(had, 0.01 * stamp.steps)) {
        settle_.pass({stamp.utime, was_taken}, arrived_, [&](Published& published) { judge(published); });
      }
    }
  }
  struct Published {
    std::int64_t utime, taken;
  };
  void judge(const Published& published) {
    ++stamped;
    const std::int64_t error = published.utime - published.taken - kMinDelay;
    if (std::abs(error) > std::abs(worst)) worst = error;
  }

  static constexpr std::int64_t kMinDelay = 200;  // us, delay
  std::mt19937 random_;
  Chances chances_;
  int busy_until_ = 0;
  std::int64_t busy_ = 0;
  std::int64_t arrived_ = 0;
  std::deque<std::pair<std::int64_t, WheelCounter::Raw>> waiting_;
  SettlingStart<Published> settle_;
  PeriodClock clock_{kPeriod};
  WheelCounter odometer_{{}};
};

TEST(PeriodClockTest, NoStampIsWrongWhateverIsLostCorruptOrLate) {
  const std::vector<std::function<double(double)>> drives = {[](double) { return 0.0; }, [](double) { return 0.4; },
                                                             [](double) { return 2.0; }, [](double) { return 10.0; },
                                                             [](double t) { return 10 * std::sin(1.5 * t); }};
  const std::vector<BadBus::Chances> buses = {{10, 0, 0, 0},   {0, 100, 0, 0},   {0, 0, 200, 0}, {0, 0, 0, 3},
                                              {10, 20, 30, 0}, {10, 20, 100, 2}, {50, 50, 50, 2}};
  for (std::size_t drive = 0; drive < drives.size(); ++drive) {
    for (std::size_t bus = 0; bus < buses.size(); ++bus) {
      for (unsigned seed = 0; seed < 10; ++seed) {
        BadBus line(seed, buses[bus]);
        line.drive(6000, drives[drive]);
        EXPECT_LE(std::abs(line.worst), 1000) << "us, drive " << drive << ", bus " << bus << ", seed " << seed;
        EXPECT_GT(3 * line.stamped, line.sent);
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::encoder
