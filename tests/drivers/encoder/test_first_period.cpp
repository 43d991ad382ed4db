#include "drivers/encoder/first_period.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace curbstone::encoder {
namespace {

constexpr std::int64_t kNominal = 10'000;  // us

struct Found {
  std::int64_t period = 0;  // us
  int after = 0;            // samples
};

/// The drive samples each `period` us; a sample comes up to `late` us late, and of 1000 so many are lost.
Found find(std::int64_t period, std::int64_t late = 300, unsigned lost = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  FirstPeriod first(kNominal);
  Found found;
  std::int64_t arrived = 0;
  for (int i = 0; i < 400; ++i) {
    if (random() % 1000 < lost) continue;
    ++found.after;
    arrived = std::max(arrived, i * period + static_cast<std::int64_t>(random() % static_cast<unsigned>(late)));
    if (const auto known = first.add(arrived)) {
      found.period = *known;
      return found;
    }
  }
  return found;
}

TEST(FirstPeriodTest, TheNominalOneIsKnownAfterAFewSamples) {
  for (const std::int64_t period : {9'900, 10'000, 10'300}) {
    EXPECT_EQ(find(period).period, kNominal);
    EXPECT_LE(find(period).after, static_cast<int>(FirstPeriod::kFew) + 1);
  }
}

TEST(FirstPeriodTest, AnotherOneIsMeasured) {
  for (const std::int64_t period : {2'500, 5'000, 8'000, 9'000, 11'000, 12'500, 20'000, 50'000}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      EXPECT_EQ(find(period, 300, 0, seed).period, period);
      EXPECT_EQ(find(period, 300, 50, seed).period, period) << "a twentieth of them is lost";
    }
  }
}

TEST(FirstPeriodTest, ALateHostCostsNoTime) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    EXPECT_LE(find(kNominal, 2'000, 0, seed).after, static_cast<int>(FirstPeriod::kFew) + 1);
    EXPECT_EQ(find(kNominal, 2'000, 0, seed).period, kNominal);
    EXPECT_EQ(find(20'000, 2'000, 0, seed).period, 20'000);
  }
}

TEST(FirstPeriodTest, ABusyHostDoesNotHideIt) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    EXPECT_EQ(find(10'000, 30'000, 10, seed).period, 10'000);
    EXPECT_NEAR(static_cast<double>(find(20'000, 30'000, 10, seed).period), 20'000, 1'000);
    EXPECT_LE(find(10'000, 30'000, 10, seed).after, static_cast<int>(FirstPeriod::kMaxSamples));
  }
}

TEST(FirstPeriodTest, AfterAnInterruptionItBeginsAnew) {
  FirstPeriod first(kNominal);
  std::optional<std::int64_t> known;
  for (int i = 0; i < 12; ++i) known = first.add(i * 20'000);
  first.restart();
  int samples = 0;
  for (std::int64_t at = 1'000'000; !known; at += kNominal, ++samples) known = first.add(at);
  EXPECT_EQ(*known, kNominal);
  EXPECT_EQ(samples, static_cast<int>(FirstPeriod::kFew) + 1);
}

}  // namespace
}  // namespace curbstone::encoder
