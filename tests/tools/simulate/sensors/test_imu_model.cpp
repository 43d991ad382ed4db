#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/sensors/imu_model.hpp"

namespace curbstone::simulate::sensors {
namespace {

TEST(ImuModel, HasTheNoiseAndTheBiasItWasGiven) {
  sensors::ImuNoise noise;
  noise.gyro_walk = noise.accelerometer_walk = 0;
  sensors::ImuModel imu(noise, {}, test_motion(), numerics::Random(4));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  constexpr int kSamples = 350;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d w = imu.sample(0.01 * i).angular_rate;  // standing
    mean += w / kSamples;
    squares += w.cwiseAbs2() / kSamples;
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(squares[i] - mean[i] * mean[i]), noise.gyro_sigma, 0.2 * noise.gyro_sigma);
    EXPECT_LT(std::abs(mean[i]), 4 * noise.gyro_bias);
  }
  EXPECT_GT(mean.norm(), 1e-4) << "no bias at all";
}

TEST(ImuModel, SaysTheSameForTheSameSeed) {
  sensors::ImuModel a({}, {}, test_motion(), numerics::Random(4)), b({}, {}, test_motion(), numerics::Random(4)),
      c({}, {}, test_motion(), numerics::Random(5));
  const auto first = a.sample(1.0), second = b.sample(1.0), other = c.sample(1.0);
  EXPECT_EQ(first.specific_force, second.specific_force);
  EXPECT_NE(first.specific_force, other.specific_force);
}

}  // namespace
}  // namespace curbstone::simulate::sensors
