#include "services/ekf/inputs/stale_counts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace curbstone::ekf::inputs {
namespace {

constexpr double kCountStep = 2 * M_PI / 4096;  // rad, of the counter
constexpr std::int64_t kEachSample = 10'000;    // us between samples

/// Samples of wheels that turn by `speed` (rad/s at a time), counted in steps, and renewed each `every` samples; the
/// right one `behind` samples later.
std::vector<base::WheelSample> counted(double seconds, const std::function<double(double)>& speed, int every,
                                       int behind = 0, double step = kCountStep) {
  std::vector<base::WheelSample> out;
  std::array<double, 2> shown = {};
  double angle = 1.0;
  for (int i = 0; i * 0.01 < seconds; ++i) {
    angle += 0.01 * speed(0.01 * i);
    if (i % every == 0) shown[0] = step * std::floor(angle / step);
    if ((i + every - behind) % every == 0) shown[1] = step * std::floor(angle / step);
    out.push_back({1'000'000 + i * kEachSample, shown});
  }
  return out;
}

std::size_t count_old(const std::vector<base::WheelSample>& samples, std::size_t from = 0) {
  StaleCounts stale_counts;
  std::size_t old = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) old += stale_counts.is_stale(samples[i]) && i >= from ? 1U : 0U;
  return old;
}

double sets_off_and_stops(double t) {
  const double up = std::clamp(5.0 * (t - 2.0), 0.0, 17.0);
  return std::min(up, std::clamp(20.0 * (8.0 - t), 0.0, 17.0));
}

TEST(StaleCounts, AreNoneWhereEachSampleIsNew) {
  EXPECT_EQ(count_old(counted(12, sets_off_and_stops, 1)), 0U);
  EXPECT_EQ(count_old(counted(
                12, [](double t) { return 0.8 * std::sin(t); }, 1)),
            0U)
      << "to and fro at a crawl";
  EXPECT_EQ(count_old(counted(
                12, [](double) { return 0.05; }, 1)),
            0U)
      << "a step each third sample";
  EXPECT_EQ(count_old(counted(
                12, [](double) { return 0.0; }, 1)),
            0U);
}

TEST(StaleCounts, AreFoundAtAnySpeedOnceTheirPeriodHasShown) {
  for (const double speed : {1.0, 3.0, 17.0, -9.0}) {
    for (const int every : {2, 5, 10, 30}) {
      const auto all = counted(
          12, [&](double) { return speed; }, every);
      const std::size_t expected =
          (all.size() - 400) / static_cast<std::size_t>(every) * static_cast<std::size_t>(every - 1);
      EXPECT_GE(count_old(all, 400), expected) << speed << " rad/s, each " << every;
      EXPECT_LE(count_old(all, 400), all.size() - 400 - (all.size() - 400) / static_cast<std::size_t>(every)) << speed;
    }
  }
}

TEST(StaleCounts, OfWheelsThatAreRenewedByTurnsBothAreNewInEachSampleThatIsUsed) {
  StaleCounts stale_counts;
  std::optional<base::WheelSample> before;
  int used = 0;
  for (const base::WheelSample& sample : counted(
           6, [](double) { return 10.0; }, 10, 5)) {
    if (stale_counts.is_stale(sample)) continue;
    if (before && sample.utime > 2'000'000) {
      ++used;
      for (std::size_t i = 0; i < 2; ++i) {
        const double rate = (sample.angle[i] - before->angle[i]) / base::seconds_between(before->utime, sample.utime);
        EXPECT_NEAR(rate, 10.0, 0.1);
      }
    }
    before = sample;
  }
  EXPECT_GE(used, 48);
}

TEST(StaleCounts, AStopIsSeenAfterAPeriodWithoutAChange) {
  StaleCounts stale_counts;
  std::int64_t believed = 0;  // us, when it first seems to stand
  std::int64_t stopped = 0;
  std::array<double, 2> angle = {};
  for (const base::WheelSample& sample : counted(12, sets_off_and_stops, 10)) {
    if (sample.angle != angle) stopped = sample.utime;
    const bool old = stale_counts.is_stale(sample);
    if (!old && sample.angle == angle && sample.utime > 8'000'000 && believed == 0) believed = sample.utime;
    angle = sample.angle;
  }
  EXPECT_GE(believed, stopped);
  EXPECT_LE(believed, stopped + 150'000);
}

TEST(StaleCounts, AWheelThatIsBrokenHoldsBackNothingForLong) {
  StaleCounts stale_counts;
  int used = 0;
  for (base::WheelSample& sample : counted(
           6, [](double) { return 17.0; }, 1)) {
    if (sample.utime > 3'000'000) sample.angle[0] = 5.0;
    if (!stale_counts.is_stale(sample) && sample.utime > 3'400'000) ++used;
  }
  EXPECT_EQ(used, 359);
}

TEST(StaleCounts, ACoarseCounterLosesNoTravel) {
  StaleCounts stale_counts;
  base::WheelSample last;
  for (const base::WheelSample& sample : counted(12, sets_off_and_stops, 1, 0, 2 * M_PI / 90)) {
    if (!stale_counts.is_stale(sample)) last = sample;
  }
  EXPECT_EQ(last.utime, 1'000'000 + 1199 * kEachSample) << "at rest all samples are used";
}

TEST(StaleCounts, ASampleOfBeforeIsNotJudged) {
  StaleCounts stale_counts;
  for (const base::WheelSample& sample : counted(
           3, [](double) { return 17.0; }, 1))
    (void)stale_counts.is_stale(sample);
  EXPECT_FALSE(stale_counts.is_stale({1'500'000, {0, 0}}));
}

}  // namespace
}  // namespace curbstone::ekf::inputs
