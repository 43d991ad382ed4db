// What a wheel cannot do, and what it can: counts that leap for one sample, and true drives in which nothing is
// refused.
#include "drivers/encoder/lone_leap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "drivers/encoder/speed_counter.hpp"
#include "drivers/encoder/wheel_counter.hpp"

namespace curbstone::encoder {
namespace {

constexpr double kCounts = 4096 / (2 * std::numbers::pi);  // per rad

TEST(LoneLeapTest, OneThatGoesBackIsRefusedAndOneThatStaysCostsASample) {
  LoneLeap leap;
  EXPECT_FALSE(leap.refuses({1, -1}, 4));
  EXPECT_TRUE(leap.refuses({20, 0}, 4));
  EXPECT_FALSE(leap.refuses({0, 0}, 4));
  EXPECT_TRUE(leap.refuses({20, 0}, 4));
  EXPECT_FALSE(leap.refuses({40, 0}, 4));
}

TEST(LoneLeapTest, WhatLeapsToAndFroIsNotRefusedForGood) {
  LoneLeap leap;
  int refused = 0;
  for (int i = 0; i < 100; ++i) refused += leap.refuses({i % 2 == 0 ? 50.0 : -50.0, 0}, 4) ? 1 : 0;
  EXPECT_LT(refused, 20) << "it is what this wheel does";
}

/// rad/s at a time, s, of either wheel.
using Speed = std::function<double(double)>;

struct Outcome {
  int published = 0;
  std::int64_t outliers = 0;
  double worst = 0;  // rad
};

/// 20 s of a drive, with `damage` done to its counts, and times of sampling that are `jitter` s early or late.
Outcome drive(double period, const Speed& left, const Speed& right, double jitter = 0,
              const std::function<void(int, WheelCounter::Raw&)>& damage = {}) {
  WheelCounter counter({.inverted = {false, false}});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> early(-jitter, jitter);
  Outcome outcome;
  std::array<double, 2> angle{}, first{};
  constexpr int kSteps = 50;
  for (int i = 0; i * period < 20; ++i) {
    for (int step = 0; i > 0 && step < kSteps; ++step) {
      const double time = (i - 1 + (step + 0.5) / kSteps) * period;
      angle[0] += left(time) * period / kSteps;
      angle[1] += right(time) * period / kSteps;
    }
    const double off = early(random);
    WheelCounter::Raw raw{static_cast<std::int32_t>(std::floor((angle[0] + off * left(i * period)) * kCounts)),
                          static_cast<std::int32_t>(std::floor((angle[1] + off * right(i * period)) * kCounts))};
    if (damage) damage(i, raw);
    const auto sample = counter.update(raw, i == 0 ? 0 : period);
    if (!sample) continue;
    if (outcome.published++ == 0) first = angle;
    for (std::size_t side = 0; side < 2; ++side)
      outcome.worst = std::max(outcome.worst, std::abs(sample->angle[side] - angle[side] + first[side]));
  }
  outcome.outliers = counter.counters()["refused.outlier"];
  return outcome;
}

TEST(TrueDrives, LoseNothing) {
  const Speed brakes = [](double t) { return t < 5 ? 6 * t : t < 5.5 ? 30 - 60 * (t - 5) : 0; };
  const Speed swings = [](double t) { return 20 * std::sin(2 * t); };
  const Speed shakes = [](double t) { return 10 + std::sin(30 * t); };
  for (const double period : {0.005, 0.01, 0.02, 0.1}) {
    for (const Speed& speed : {brakes, swings, shakes}) {
      const Outcome outcome = drive(period, speed, [&](double t) { return 0.8 * speed(t); });
      EXPECT_LE(outcome.outliers, 1) << period;
    }
  }
}

TEST(TrueDrives, AWheelThatSpinsOrLocksCostsASampleEachTime) {
  const Speed slips = [](double t) { return std::fmod(t, 2) < 0.5 ? 27 : 17; };
  const Speed locks = [](double t) { return std::fmod(t, 2) < 0.5 ? 0 : 17; };
  for (const Speed& speed : {slips, locks}) {
    const Outcome outcome = drive(0.01, speed, [](double) { return 17; });
    EXPECT_LE(outcome.outliers, 30);
    EXPECT_LT(outcome.worst, 0.01);
  }
}

TEST(TrueDrives, ADriveThatSamplesUnevenlyIsRead) {
  const Speed steady = [](double) { return 15; };
  for (const double jitter : {0.0005, 0.002, 0.005}) {
    const Outcome outcome = drive(0.01, steady, steady, jitter);
    EXPECT_LE(outcome.outliers, 20) << jitter;
  }
}

TEST(DamagedDrives, EachSampleThatIsDamagedIsRefused) {
  for (const double period : {0.01, 0.02}) {
    for (const double speed : {0.0, 2.0, -17.0, 60.0}) {
      std::mt19937 random(9);
      int damaged = 0, last = 0;
      const auto damage = [&](int i, WheelCounter::Raw& raw) {
        if (i < 3 || i == last + 1 || random() % 20 != 0) return;
        last = i;
        raw[random() % 2] ^= 1 << (5 + random() % 5);  // 32 to 512 counts
        ++damaged;
      };
      const Speed steady = [&](double) { return speed; };
      const Outcome outcome = drive(period, steady, steady, 0, damage);
      EXPECT_LT(outcome.worst, 0.02) << period << " s, " << speed << " rad/s";
      EXPECT_GE(outcome.published + damaged + 5, 20 / period);
    }
  }
}

/// rad/s that a speed counter takes of those that it is given.
std::vector<double> taken(const std::vector<double>& speeds, double resolution = 0.01) {
  SpeedCounter counter({.inverted = {false, false}}, resolution);
  std::vector<double> taken;
  for (const double speed : speeds) {
    if (const auto sample = counter.update({speed, 5.0}, 0.01)) taken.push_back(sample->speed[0]);
  }
  return taken;
}

TEST(SpeedCounterTest, ASpeedThatLeapsForASampleIsRefusedAndOneThatStaysIsNot) {
  using Speeds = std::vector<double>;
  EXPECT_EQ(taken({5, 5, 5, 37, 5, 5}), (Speeds{5, 5, 5, 5}));
  EXPECT_EQ(taken({5, 5, 5, -11, 5}), (Speeds{5, 5, 5}));
  EXPECT_EQ(taken({5, 5, 9, 9, 9}), (Speeds{5, 9, 9}));
  EXPECT_EQ(taken({5, 5, 6, 7, 6, 5}, 1.0), (Speeds{5, 6, 7, 6, 5})) << "steps of 1 rad/s are its resolution";
}

TEST(SpeedCounterTest, TheFirstSpeedIsUsedWhenTheSecondConfirmsIt) {
  EXPECT_EQ(taken({37, 5, 5, 5}), (std::vector<double>{5, 5}));
  EXPECT_EQ(taken({5, 5, 5}), (std::vector<double>{5, 5}));
}

}  // namespace
}  // namespace curbstone::encoder
