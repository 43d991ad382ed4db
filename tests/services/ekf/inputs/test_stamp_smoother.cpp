#include "services/ekf/inputs/stamp_smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/services/ekf/real_drives.hpp"
#include "tests/stamps.hpp"

namespace curbstone::ekf::inputs {
namespace {

using test::kStart;

struct Taken {
  std::int64_t time = 0;   // us, true
  std::int64_t stamp = 0;  // us
  std::int32_t sequence = 0;
};

class StampSmootherTest : public ::testing::Test {
 protected:
  /// Samples each `interval` us, stamped late by what a busy host makes of it: up to 20 ms, 50 ms for one of 30.
  void sample(int count, std::int64_t interval, bool late) {
    for (int i = 0; i < count; ++i) {
      now_ += interval;
      const double share = std::uniform_real_distribution<>(0, 1)(random_);
      const double delay = share < 1.0 / 30 ? 50e3 : std::uniform_real_distribution<>(0, 20e3)(random_);
      const std::int64_t before = samples_.empty() ? 0 : samples_.back().stamp + 100;
      const std::int64_t stamp = now_ + (late ? std::llround(delay) : 0);
      samples_.push_back({now_, std::abs(stamp - before) < 1'000'000 ? std::max(stamp, before) : stamp, sequence_++});
    }
  }
  void lose(double share) {
    std::erase_if(samples_, [&](const Taken&) { return std::uniform_real_distribution<>(0, 1)(random_) < share; });
  }
  void run() {
    StampSmoother straightener;
    for (const Taken& s : samples_) out_.push_back(straightener.add(s.stamp, s.sequence));
  }
  void expect_unchanged() {
    for (std::size_t i = 0; i < samples_.size(); ++i) ASSERT_EQ(out_[i], samples_[i].stamp) << i;
  }
  void expect_order(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      ASSERT_LE(out_[i], samples_[i].stamp) << i;
      ASSERT_GT(out_[i], i > from ? out_[i - 1] : 0) << i;
    }
  }
  /// From sample `from` on to `to` they are as taken.
  void expect_straight(std::size_t from, std::size_t to, double mean_us = 1'500) {
    double mean = 0;
    for (std::size_t i = from; i < to; ++i) {
      const auto off = static_cast<double>(out_[i] - samples_[i].time);
      mean += std::abs(off) / static_cast<double>(to - from);
      EXPECT_LT(off, 10'000) << i;
      EXPECT_GT(off, -3'000) << i;
    }
    std::printf("[ figure ] off by %.2f ms on average\n", 1e-3 * mean);
    EXPECT_LT(mean, mean_us);
  }

  std::vector<Taken> samples_;
  std::vector<std::int64_t> out_;
  std::int64_t now_ = kStart;
  std::int32_t sequence_ = 0;
  std::mt19937 random_{1};
};

TEST_F(StampSmootherTest, RegularStampsAreKeptBitForBit) {
  sample(2000, 10'000, false);
  for (Taken& s : samples_) s.stamp += std::uniform_int_distribution<>(-300, 300)(random_);
  lose(0.02);
  sample(1000, 5'000, false);
  now_ += 700'000;
  sample(1000, 5'000, false);
  now_ -= 40'000'000;
  sample(1000, 5'000, false);
  now_ += 90'000'000;
  sample(1000, 2'500, false);
  run();
  expect_unchanged();
}

TEST_F(StampSmootherTest, RegularStampsAreKeptThoughLossesDoNotShow) {
  sample(4000, 10'000, false);
  lose(0.02);
  for (Taken& s : samples_) s.sequence = 0;
  run();
  expect_unchanged();
}

TEST_F(StampSmootherTest, UnevenSamplingIsKept) {
  for (int i = 0; i < 4000; ++i) sample(1, std::uniform_int_distribution<>(6'000, 14'000)(random_), false);
  run();
  expect_unchanged();
}

TEST_F(StampSmootherTest, LateStampsBecomeEven) {
  for (const std::int64_t interval : {10'000, 5'000}) {
    samples_.clear();
    out_.clear();
    sample(6000, interval, true);
    run();
    expect_order(0, samples_.size());
    expect_straight(1000, samples_.size());
  }
}

TEST_F(StampSmootherTest, LostSamplesShowInTheSequence) {
  sample(6000, 10'000, true);
  lose(0.05);
  run();
  expect_order(0, samples_.size());
  expect_straight(1000, samples_.size());
}

TEST_F(StampSmootherTest, ALossThatDoesNotShowPutsThemEarlyByItAndNoMoreForSeconds) {
  sample(3000, 10'000, true);
  samples_.erase(samples_.begin() + 1500);
  for (Taken& s : samples_) s.sequence = 0;
  run();
  expect_order(0, samples_.size());
  for (std::size_t i = 1000; i < samples_.size(); ++i) EXPECT_GT(out_[i] - samples_[i].time, -15'000) << i;
  expect_straight(2300, samples_.size());
}

TEST_F(StampSmootherTest, AnotherRateIsLearntAnew) {
  sample(2000, 10'000, true);
  sample(3000, 5'000, true);
  sample(3000, 10'000, true);
  run();
  expect_order(0, samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) EXPECT_GT(out_[i] - samples_[i].time, -85'000) << i;
  expect_straight(3500, 5000);
  expect_straight(6500, 8000);
}

TEST_F(StampSmootherTest, AClockThatIsSetAndAPauseAreFollowed) {
  for (const std::int64_t step : {-30'000'000, -200'000, 200'000, 5'000'000}) {
    samples_.clear();
    out_.clear();
    sample(2000, 10'000, true);
    now_ += step;
    sample(2000, 10'000, true);
    for (std::size_t i = 2000; step == -200'000 && i < 2030; ++i) samples_[i].stamp = samples_[i].time;
    run();
    expect_order(2050, samples_.size());
    expect_straight(3000, samples_.size());
  }
}

TEST_F(StampSmootherTest, ADoubleIsADoubleAndOneWildStampChangesNothing) {
  sample(2000, 10'000, true);
  const auto good = samples_;
  run();
  const auto undisturbed = out_;
  StampSmoother straightener;
  for (std::size_t i = 0; i < good.size(); ++i) {
    const std::int64_t out = straightener.add(good[i].stamp, good[i].sequence);
    ASSERT_EQ(out, undisturbed[i]);
    ASSERT_EQ(straightener.add(good[i].stamp, good[i].sequence), out);
    if (i % 100 == 50) {
      ASSERT_EQ(straightener.add(kStart + 86'400'000'000, 7), kStart + 86'400'000'000);
    }
  }
}

TEST_F(StampSmootherTest, RecordedStampsAreKeptBitForBit) {
  for (const std::string& name : real_drive_names()) {
    const auto real = real_drive(name);
    if (!real) GTEST_SKIP() << "../shared/data is not there";
    StampSmoother straightener;
    for (const base::ImuSample& s : real->drive.imu) ASSERT_EQ(straightener.add(s.utime, 0), s.utime) << name;
  }
}

}  // namespace
}  // namespace curbstone::ekf::inputs
