#include "services/ekf/filter/rewinding_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

using Sample = RewindingFilter::Sample;

std::int64_t stamp_of(const Sample& sample) {
  return std::visit([](const auto& s) { return s.utime; }, sample);
}

class Rewinding : public ::testing::Test {
 protected:
  Rewinding() {
    DriveOptions o;
    o.seconds = 25.0;
    o.gyro_bias << 0.004, -0.006, 0.008;
    o.accelerometer_bias << 0.03, -0.02, 0.04;
    drive_ = simulate_drive(o, config_.vehicle);
    for (const base::ImuSample& s : drive_.imu) samples_.emplace_back(s);
    for (const base::WheelSample& s : drive_.wheels) samples_.emplace_back(s);
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const Sample& a, const Sample& b) { return stamp_of(a) < stamp_of(b); });
  }

  struct Result {
    explicit Result(const base::EkfConfig& config) : filter(config) {}
    RewindingFilter filter;
    std::vector<model::Estimate> estimates;
  };
  Result run(const std::vector<Sample>& samples) {
    Result result(config_);
    for (const Sample& s : samples) result.filter.add(s, result.estimates);
    return result;
  }
  /// Each sample that `late` picks comes `delay` s of message time later than it should.
  template <class Late>
  std::vector<Sample> delayed(double delay, Late late) {
    std::vector<std::pair<std::int64_t, Sample>> arrivals;
    for (const Sample& s : samples_)
      arrivals.emplace_back(stamp_of(s) + (late(s) ? static_cast<std::int64_t>(delay * 1e6) : 0), s);
    std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Sample> out;
    for (const auto& [time, s] : arrivals) out.push_back(s);
    return out;
  }
  double seconds_in(std::int64_t utime) { return base::seconds_between(drive_.imu.front().utime, utime); }

  static void expect_continuous(const std::vector<model::Estimate>& estimates) {
    for (std::size_t i = 1; i < estimates.size(); ++i) {
      const model::Estimate& a = estimates[i - 1];
      const model::Estimate& b = estimates[i];
      ASSERT_GT(b.utime, a.utime);
      const double dt = base::seconds_between(a.utime, b.utime);
      const Pose step = a.T_odom_base.inverse() * b.T_odom_base;
      EXPECT_LT((step.translation() - dt * b.velocity).norm(), 2e-3 + 0.05 * dt) << i;
      EXPECT_LT(std::abs(roll_pitch_yaw(step.linear()).z() - dt * b.angular_rate.z()), 1e-3) << i;
    }
  }

  base::EkfConfig config_;
  Drive drive_;
  std::vector<Sample> samples_;
};

TEST_F(Rewinding, LateSamplesLeadToTheVeryBeliefOfOrderedOnes) {
  const Result ordered = run(samples_);
  std::mt19937 random(3);
  const Result late = run(delayed(0.6, [&](const Sample& s) {
    return seconds_in(stamp_of(s)) < 23.0 && random() % 20 == 0;  // the last ones have come by the end
  }));
  EXPECT_GT(late.filter.counters()["rewound.imu"], 50);
  EXPECT_GT(late.filter.counters()["rewound.wheels"], 50);
  const model::Belief& a = ordered.filter.filter().belief();
  const model::Belief& b = late.filter.filter().belief();
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(model::minus(a.mean, b.mean).norm(), 0.0);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(ordered.filter.filter().counters().values(), late.filter.filter().counters().values());
}

TEST_F(Rewinding, AnEncoderThatSleptForMoreThanASecondCountsInFull) {
  const Result ordered = run(samples_);
  std::vector<Sample> samples;
  std::vector<Sample> waiting;  // read in one go at 13.5 s
  for (const Sample& s : samples_) {
    const double t = seconds_in(stamp_of(s));
    if (t >= 13.5) samples.insert(samples.end(), waiting.begin(), waiting.end()), waiting.clear();
    if (std::holds_alternative<base::WheelSample>(s) && t > 12.0 && t < 13.5)
      waiting.push_back(s);
    else
      samples.push_back(s);
  }
  const Result late = run(samples);
  EXPECT_EQ(late.filter.counters()["rewound.wheels"], 149);  // of 150 the newest is not late
  EXPECT_EQ(late.filter.filter().belief().covariance, ordered.filter.filter().belief().covariance);
  expect_continuous(late.estimates);
}

TEST_F(Rewinding, OdomGoesOnFromWhereItWasAndNoStampIsGivenTwice) {
  // The wheels of two seconds come 0.6 s late, all at once: meanwhile it coasts on the IMU.
  const Result late = run(delayed(0.6, [&](const Sample& s) {
    return std::holds_alternative<base::WheelSample>(s) && std::abs(seconds_in(stamp_of(s)) - 12.0) < 1.0;
  }));
  EXPECT_GT(late.filter.counters()["rewound.wheels"], 100);
  expect_continuous(late.estimates);
}

TEST_F(Rewinding, AnImuThatComesLateCountsThoughTheWheelsHaveBridgedItsSilence) {
  const auto late_imu = delayed(0.7, [&](const Sample& s) {
    return std::holds_alternative<base::ImuSample>(s) && std::abs(seconds_in(stamp_of(s)) - 12.0) < 0.4;
  });
  const Result late = run(late_imu);
  const Result ordered = run(samples_);
  expect_continuous(late.estimates);
  EXPECT_TRUE(
      std::any_of(late.estimates.begin(), late.estimates.end(), [](const model::Estimate& e) { return e.no_imu; }));
  EXPECT_EQ(ordered.filter.filter().belief().covariance, late.filter.filter().belief().covariance);
  // What it coasted wrong stays in odom, and the covariance says so.
  const model::Estimate& a = ordered.estimates.back();
  const model::Estimate& b = late.estimates.back();
  EXPECT_EQ(a.velocity, b.velocity);
  const double moved = (a.T_odom_base.translation() - b.T_odom_base.translation()).norm();
  EXPECT_GT(moved, 0.0);
  EXPECT_LT(moved, 1.0);
  EXPECT_GT(b.pose_covariance(0, 0) + b.pose_covariance(1, 1), a.pose_covariance(0, 0) + a.pose_covariance(1, 1));
}

TEST_F(Rewinding, DropsWhatIsOlderThanItsHistoryAndWhatItHasAlready) {
  std::vector<Sample> samples(samples_.begin(), samples_.begin() + 1000);
  const Result clean = run(samples);
  samples.push_back(samples_[990]);
  Result result = run(samples);
  EXPECT_EQ(result.filter.counters()["dropped.duplicate.imu"] + result.filter.counters()["dropped.duplicate.wheels"],
            1);
  EXPECT_EQ(result.filter.filter().belief().covariance, clean.filter.filter().belief().covariance);
}

TEST_F(Rewinding, RemembersNoMoreThanItsHistory) {
  config_.timing.history = 0.5;
  std::vector<Sample> samples = samples_;
  base::WheelSample old = drive_.wheels[1000];
  old.utime += 1;
  samples.insert(samples.begin() + 2150, Sample{old});  // 0.75 s late
  const Result result = run(samples);
  // To a filter with this history such a stamp is a clock turned back: the sequencer does not let it through.
  EXPECT_GE(result.filter.filter().counters()["reset.clock"], 1);
  expect_continuous({result.estimates.end() - 200, result.estimates.end()});
}

TEST_F(Rewinding, TakesAMapIncrementAtItsOwnTimeAndLearnsTheWheelsScale) {
  DriveOptions o;
  o.seconds = 40.0;
  o.stop_at = 1e9;
  o.wheel_scale << 0.02, 0.02, 0.0;  // a poor prior: 2 %
  const Drive drive = simulate_drive(o, config_.vehicle);
  config_.wheels.scale_sigma = 0.02;
  std::array<double, 2> late_error = {};  // m of way, second half: what was lost before it had learnt stays in odom
  std::array<double, 2> scale_error = {};
  for (const bool fused : {false, true}) {
    RewindingFilter filter(config_);
    std::vector<model::Estimate> out;
    for (std::size_t i = 0; i < drive.imu.size(); ++i) {
      filter.add(drive.imu[i], out);
      filter.add(drive.wheels[i], out);
      if (!fused || i % 50 != 30 || i < 200) continue;
      inputs::MapIncrement m;
      m.begin = drive.imu[i - 80].utime;
      m.utime = drive.imu[i - 30].utime;
      m.T_begin_end = drive.truth[i - 80].T_world_base.inverse() * drive.truth[i - 30].T_world_base;
      m.covariance = Eigen::Matrix<double, 6, 6>::Identity() * 1e-5;
      filter.add(m, out);
    }
    const model::Estimate& middle = out[out.size() / 2];
    const Pose truth = drive.truth[drive.index_of(middle.utime)].T_world_base.inverse() *
                       drive.truth[drive.index_of(out.back().utime)].T_world_base;
    const Pose estimate = middle.T_odom_base.inverse() * out.back().T_odom_base;
    late_error[fused] = std::abs(truth.translation().norm() - estimate.translation().norm());
    scale_error[fused] = std::abs(filter.filter().belief().mean.wheel_scale[0] - 0.02);
    expect_continuous(out);
    if (fused) {
      EXPECT_GT(filter.counters()["map.used"], 60);
    }
  }
  EXPECT_LT(scale_error[1], 0.001);
  EXPECT_LT(scale_error[1], 0.5 * scale_error[0]);
  EXPECT_LT(late_error[1], late_error[0]);
  EXPECT_LT(late_error[1], 0.001 * drive.distance);
}

}  // namespace
}  // namespace curbstone::ekf::filter
