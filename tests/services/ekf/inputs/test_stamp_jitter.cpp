#include "services/ekf/inputs/stamp_jitter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/services/ekf/late_stamps.hpp"

namespace curbstone::ekf::inputs {
namespace {

constexpr double kRadius = 0.1;

/// Samples of wheels that turn at `speed(t)` m/s, each `period` s for a minute.
template <class Speed>
std::vector<base::WheelSample> samples_of(double period, Speed speed) {
  std::vector<base::WheelSample> samples;
  double way = 0.0;
  for (int i = 0; i < static_cast<int>(60.0 / period); ++i) {
    const double t = period * i;
    samples.push_back({std::llround(1e6 * t), {way / kRadius, way / kRadius}});
    way += period * speed(t + 0.5 * period);
  }
  return samples;
}

/// ms, the largest sigma that was learnt, or the last one.
struct Learnt {
  double most = 0.0, last = 0.0;
};
Learnt learn(const std::vector<base::WheelSample>& samples) {
  StampJitter jitter(base::WheelsConfig(), kRadius);
  Learnt learnt;
  for (const base::WheelSample& sample : samples) {
    jitter.add(sample);
    learnt.last = 1e3 * jitter.sigma();
    learnt.most = std::max(learnt.most, learnt.last);
  }
  return learnt;
}

double three(double) {
  return 3.0;
}
/// Speeds up and brakes at 2 m/s^2, and stands in between.
double stop_and_go(double t) {
  const double phase = std::fmod(t, 8.0);
  return std::clamp(std::min(2.0 * phase, 2.0 * (6.0 - phase)), 0.0, 3.0);
}
double backwards(double t) {
  return -stop_and_go(t);
}

TEST(StampJitterTest, GoodStampsShowNoneHoweverTheVehicleDrives) {
  for (const double period : {0.0025, 0.01, 0.05}) {
    EXPECT_EQ(learn(samples_of(period, three)).most, 0.0) << period;
    EXPECT_EQ(learn(samples_of(period, stop_and_go)).most, 0.0) << period;
    EXPECT_EQ(learn(samples_of(period, backwards)).most, 0.0) << period;
    EXPECT_EQ(learn(samples_of(period, [](double) { return 0.0; })).most, 0.0) << period;
  }
}

TEST(StampJitterTest, HowLateStampsJitterIsLearnt) {
  for (const double late : {0.002, 0.005, 0.01}) {
    for (const double period : {0.01, 0.02, 0.05}) {
      auto samples = samples_of(period, stop_and_go);
      make_late(samples, late, 1);
      const double sigma = 1e3 * late / std::sqrt(12.0);  // of an even distribution
      EXPECT_NEAR(learn(samples).last / sigma, 1.0, 0.3) << late << " s late, each " << period;
    }
  }
}

/// Their stamps are true.
TEST(StampJitterTest, LostSamplesAndSamplesTakenUnevenlyAreNoJitter) {
  std::mt19937 random(1);
  auto lost = samples_of(0.01, stop_and_go);
  std::erase_if(lost, [&](const auto&) { return random() % 3 == 0; });
  EXPECT_EQ(learn(lost).most, 0.0);
  auto uneven = samples_of(0.001, three);
  std::erase_if(uneven, [&](const auto&) { return random() % 10 != 0; });
  EXPECT_EQ(learn(uneven).most, 0.0);
}

/// Slip, or a wheel that does not turn: the other one has the same stamps.
TEST(StampJitterTest, WhatOneWheelShowsAloneIsNoJitter) {
  auto samples = samples_of(0.01, three);
  std::mt19937 random(1);
  double spun = 0.0;
  for (base::WheelSample& sample : samples) {
    sample.angle[0] += spun += 0.1 * static_cast<double>(random() % 4);
    if (sample.utime > 30'000'000) sample.angle[0] = 0.0;
  }
  EXPECT_EQ(learn(samples).most, 0.0);
}

TEST(StampJitterTest, ItIsForgottenOnceItIsOver) {
  auto samples = samples_of(0.01, three);
  auto late = samples;
  make_late(late, 0.02, 1);
  std::copy(late.begin(), late.begin() + 3000, samples.begin());
  const Learnt learnt = learn(samples);
  EXPECT_GT(learnt.most, 4.0);
  EXPECT_EQ(learnt.last, 0.0);
}

}  // namespace
}  // namespace curbstone::ekf::inputs
