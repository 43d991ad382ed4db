#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "services/ekf/model/measurement_model.hpp"
#include "services/ekf/model/process_model.hpp"

namespace curbstone::ekf::model {

/// A vehicle in mid-turn on a slope, with nothing at zero, and derivatives by its error state.
class ModelTest : public ::testing::Test {
 protected:
  ModelTest() {
    vehicle_.imu = {0.3, -0.2, 0.5, 0.1, -0.2, 0.3};
    state_.position << 3, -2, 1;
    state_.velocity << 2.5, 0.3, -0.1;
    state_.attitude = Eigen::Quaterniond(rotation_from_rpy(0.1, -0.2, 1.3));
    state_.gyro_bias << 0.01, -0.02, 0.03;
    state_.accelerometer_bias << 0.1, -0.1, 0.05;
    state_.wheel_scale << 0.01, -0.02, 0.03;
    state_.axle = -0.4;
    state_.course << 0.02, -0.03;
    imu_.angular_rate << 0.3, -0.5, 1.1;
    imu_.acceleration << 0.7, -1.2, 9.5;
  }

  /// Columns: derivative of f by each direction of the error state, by central differences.
  static Eigen::MatrixXd numeric(const std::function<Eigen::VectorXd(const ErrorVector&)>& f) {
    constexpr double kDelta = 1e-5;
    Eigen::MatrixXd J(f(ErrorVector::Zero()).size(), static_cast<int>(kErrorSize));
    for (int i = 0; i < kErrorSize; ++i) {
      const ErrorVector d = kDelta * ErrorVector::Unit(i);
      J.col(i) = (f(d) - f(-d)) / (2.0 * kDelta);
    }
    return J;
  }

  /// H of an observation whose expected value is -residual up to a constant.
  template <class Observe>
  void expect_jacobian_matches(const Observe& observe) {
    const Eigen::MatrixXd expected =
        numeric([&](const ErrorVector& e) -> Eigen::VectorXd { return -observe(plus(state_, e)).residual; });
    EXPECT_LT((observe(state_).H - expected).cwiseAbs().maxCoeff(), 1e-7) << observe(state_).H << "\n\n" << expected;
  }

  VehicleConfig vehicle_;
  NavState state_;
  Inertial imu_;
};

}  // namespace curbstone::ekf::model
