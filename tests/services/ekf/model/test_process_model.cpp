#include "services/ekf/model/process_model.hpp"

#include <gtest/gtest.h>

#include "tests/services/ekf/model/model_fixture.hpp"

namespace curbstone::ekf::model {
namespace {

using ProcessModelTest = ModelTest;

TEST_F(ProcessModelTest, TransitionIsTheDerivativeOfTheIntegration) {
  for (const double dt : {0.0025, 0.01, 0.05}) {
    const NavState next = integrate(state_, imu_, dt);
    const Eigen::MatrixXd expected = numeric(
        [&](const ErrorVector& e) -> Eigen::VectorXd { return minus(integrate(plus(state_, e), imu_, dt), next); });
    EXPECT_LT((transition(state_, imu_, dt) - expected).cwiseAbs().maxCoeff(), 2e-6) << "dt " << dt;
  }
}

TEST_F(ProcessModelTest, AVehicleAtRestStaysAtRest) {
  NavState rest;
  rest.attitude = Eigen::Quaterniond(rotation_from_rpy(0.1, -0.2, 0.7));
  const Inertial imu{Eigen::Vector3d::Zero(), rest.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity)};
  NavState state = rest;
  for (int i = 0; i < 1000; ++i) state = integrate(state, imu, 0.01);
  EXPECT_LT(minus(state, rest).norm(), 1e-9);
}

TEST_F(ProcessModelTest, AnEvenCircleClosesAfterOneTurn) {
  // radius v/w = 2 m, specific force v*w inwards (left) and gravity
  NavState state;
  state.velocity << 2, 0, 0;
  const NavState start = state;
  const Inertial imu{{0, 0, 1}, {0, 2, kGravity}};
  const int n = 1000;
  for (int i = 0; i < n; ++i) state = integrate(state, imu, 2.0 * M_PI / n);
  EXPECT_LT(minus(state, start).norm(), 1e-3);
}

/// White noise of density q on a rate, for t seconds: the angle's variance is q^2 t, that of its integral q^2 t^3 / 3.
TEST_F(ProcessModelTest, TheNoiseOfTheSensorsIsThatOfTheirDensities) {
  const auto after_two_seconds = [](const base::NoiseConfig& noise) {
    Belief belief;  // nothing is uncertain yet
    for (int i = 0; i < 400; ++i) predict(belief, {Eigen::Vector3d::Zero(), {0, 0, kGravity}}, 0.005, noise);
    return Eigen::VectorXd(belief.covariance.diagonal());
  };
  base::NoiseConfig noise;
  noise.gyro = noise.accelerometer = noise.gyro_bias_walk = noise.accelerometer_bias_walk = noise.wheel_scale_walk = 0;
  const base::NoiseConfig none = noise;
  EXPECT_EQ(after_two_seconds(none).norm(), 0.0);

  noise.gyro = 1e-3;
  const Eigen::VectorXd by_gyro = after_two_seconds(noise);
  EXPECT_NEAR(by_gyro[kAttitude + 2], 1e-6 * 2, 1e-8);
  EXPECT_NEAR(by_gyro[kVelocity], 1e-6 * kGravity * kGravity * 8 / 3, 0.02 * by_gyro[kVelocity]) << "by the tilt";

  noise = none;
  noise.accelerometer = 1e-2;
  const Eigen::VectorXd by_accelerometer = after_two_seconds(noise);
  EXPECT_NEAR(by_accelerometer[kVelocity + 1], 1e-4 * 2, 1e-6);
  EXPECT_NEAR(by_accelerometer[kPosition + 1], 1e-4 * 8 / 3, 0.02 * by_accelerometer[kPosition + 1]);

  noise = none;
  noise.gyro_bias_walk = 1e-4;
  noise.accelerometer_bias_walk = 2e-4;
  noise.wheel_scale_walk = 3e-4;
  const Eigen::VectorXd by_walks = after_two_seconds(noise);
  EXPECT_NEAR(by_walks[kGyroBias], 1e-8 * 2, 1e-12);
  EXPECT_NEAR(by_walks[kAccelerometerBias], 4e-8 * 2, 1e-12);
  EXPECT_NEAR(by_walks[kWheelScale], 9e-8 * 2, 1e-12);
  EXPECT_NEAR(by_walks[kAttitude + 2], 1e-8 * 8 / 3, 0.02 * by_walks[kAttitude + 2]);
  EXPECT_EQ(by_walks[kAxle], 0.0);
}

TEST_F(ProcessModelTest, NothingThatIsMeasuredDependsOnPositionOrYaw) {
  // This is why the velocity is kept in body axes: turning and moving the odom frame changes no prediction.
  const ErrorMatrix F = transition(state_, imu_, 0.01);
  ErrorVector turn = ErrorVector::Zero();
  turn.segment<3>(kAttitude) = state_.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((F * turn).segment<3>(kVelocity).norm(), 1e-12);
}

}  // namespace
}  // namespace curbstone::ekf::model
