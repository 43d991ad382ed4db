#include "services/ekf/inputs/imu_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>

namespace curbstone::ekf::inputs {
namespace {

constexpr double kStep = 0.01;  // s

using Rate = std::function<double(double)>;
double no_turn(double /*t*/) {
  return 0.0;
}

/// White noise of these sigmas about a motion's rate, which the accelerometer feels tenfold.
class Imu {
 public:
  Imu(double gyro_sigma, double accelerometer_sigma, Rate rate = no_turn)
      : gyro_sigma_(gyro_sigma), accelerometer_sigma_(accelerometer_sigma), rate_(std::move(rate)) {}

  [[nodiscard]] base::ImuSample at(double t) {
    base::ImuSample sample;
    sample.utime = std::llround(1e6 * t);
    sample.angular_rate = Eigen::Vector3d(0, 0, rate_(t)) + draw(gyro_sigma_);
    sample.acceleration = Eigen::Vector3d(10.0 * rate_(t), 0, 9.81) + draw(accelerometer_sigma_);
    return sample;
  }

 private:
  Eigen::Vector3d draw(double sigma) {
    return {sigma * normal_(engine_), sigma * normal_(engine_), sigma * normal_(engine_)};
  }
  double gyro_sigma_, accelerometer_sigma_;
  Rate rate_;
  std::mt19937 engine_{7};
  std::normal_distribution<double> normal_;
};

void run(ImuNoise& noise, Imu imu, double from, double to, double step = kStep) {
  for (int i = 0; i < std::lround((to - from) / step); ++i) noise.add(imu.at(from + i * step));
}

TEST(ImuNoise, IsTheDensityOfWhiteNoiseAtAnyRate) {
  for (const double step : {0.0025, 0.01, 0.02}) {
    ImuNoise noise;
    run(noise, {0.02, 3.0}, 0, 10, step);
    EXPECT_NEAR(noise.gyro(), 0.02 * std::sqrt(step), 0.2 * 0.02 * std::sqrt(step)) << step;
    EXPECT_NEAR(noise.accelerometer(), 3.0 * std::sqrt(step), 0.2 * 3.0 * std::sqrt(step)) << step;
  }
}

TEST(ImuNoise, OfWhatAVehicleDoesShowsHardly) {
  ImuNoise noise;
  run(noise, {0, 0, [](double t) { return 0.3 * std::sin(2 * std::numbers::pi * t) + 0.2 * t; }}, 0, 10);
  EXPECT_LT(noise.gyro(), base::NoiseConfig().gyro);
  EXPECT_LT(noise.accelerometer(), base::NoiseConfig().accelerometer);
}

TEST(ImuNoise, OneLeapIsNoNoise) {
  ImuNoise noise;
  run(noise, {0.0012, 0.012}, 0, 5);
  const double before = noise.gyro();
  run(noise, {0.0012, 0.012, [](double) { return 1.0; }}, 5, 5.05);
  EXPECT_LT(noise.gyro(), 1.3 * before);
}

TEST(ImuNoise, IsKnownAfterASecondOfShakingAndForgottenAfterSome) {
  ImuNoise noise;
  run(noise, {0.0012, 0.012}, 0, 5);
  run(noise, {0.0012, 3.0}, 5, 6.5);
  EXPECT_GT(noise.accelerometer(), 0.2);
  run(noise, {0.0012, 0.012}, 6.5, 16.5);
  EXPECT_LT(noise.accelerometer(), 0.01);
}

TEST(ImuNoise, ChangesNothingUpToTwiceWhatIsConfiguredAndCountsBeyond) {
  const base::NoiseConfig configured;
  ImuNoise usual, poor;
  run(usual, {0.0020, 0.15}, 0, 10);
  EXPECT_EQ(usual.applied_to(configured).gyro, configured.gyro);
  EXPECT_EQ(usual.applied_to(configured).accelerometer, configured.accelerometer);
  EXPECT_EQ(usual.beyond(configured).gyro, 0.0);
  EXPECT_EQ(usual.beyond(configured).accelerometer, 0.0);
  run(poor, {0.02, 3.0}, 0, 10);
  EXPECT_NEAR(poor.applied_to(configured).gyro, 2e-3, 4e-4);
  EXPECT_NEAR(poor.beyond(configured).accelerometer, 0.3, 0.06);
  EXPECT_NEAR(poor.beyond(configured).per_sample, 10.0, 1e-3);
}

TEST(ImuNoise, SaysNothingOfSamplesOutOfStep) {
  ImuNoise noise;
  for (int i = 0; i < 1000; ++i) {
    base::ImuSample sample;
    sample.utime = 10'000 * i + (i % 2 == 0 ? 0 : 8'000);
    sample.angular_rate.z() = i % 3;
    noise.add(sample);
  }
  EXPECT_EQ(noise.gyro(), 0.0);
  EXPECT_EQ(noise.applied_to({}).gyro, base::NoiseConfig().gyro);
}

}  // namespace
}  // namespace curbstone::ekf::inputs
