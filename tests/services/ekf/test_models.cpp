#include <gtest/gtest.h>

#include <functional>

#include "services/ekf/measurement_model.hpp"
#include "services/ekf/process_model.hpp"

namespace curbstone {
namespace {

class Models : public ::testing::Test {
 protected:
  Models() {
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

TEST_F(Models, MinusUndoesPlus) {
  ErrorVector error = ErrorVector::Random() * 0.5;
  EXPECT_LT((minus(plus(state_, error), state_) - error).norm(), 1e-12);
}

TEST_F(Models, TransitionIsTheDerivativeOfTheIntegration) {
  for (const double dt : {0.0025, 0.01, 0.05}) {
    const NavState next = integrate(state_, imu_, dt);
    const Eigen::MatrixXd expected = numeric(
        [&](const ErrorVector& e) -> Eigen::VectorXd { return minus(integrate(plus(state_, e), imu_, dt), next); });
    EXPECT_LT((transition(state_, imu_, dt) - expected).cwiseAbs().maxCoeff(), 2e-6) << "dt " << dt;
  }
}

TEST_F(Models, AVehicleAtRestStaysAtRest) {
  NavState rest;
  rest.attitude = Eigen::Quaterniond(rotation_from_rpy(0.1, -0.2, 0.7));
  const Inertial imu{Eigen::Vector3d::Zero(), rest.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity)};
  NavState state = rest;
  for (int i = 0; i < 1000; ++i) state = integrate(state, imu, 0.01);
  EXPECT_LT(minus(state, rest).norm(), 1e-9);
}

TEST_F(Models, AnEvenCircleClosesAfterOneTurn) {
  // radius v/w = 2 m, specific force v*w inwards (left) and gravity
  NavState state;
  state.velocity << 2, 0, 0;
  const NavState start = state;
  const Inertial imu{{0, 0, 1}, {0, 2, kGravity}};
  const int n = 1000;
  for (int i = 0; i < n; ++i) state = integrate(state, imu, 2.0 * M_PI / n);
  EXPECT_LT(minus(state, start).norm(), 1e-3);
}

TEST_F(Models, NothingThatIsMeasuredDependsOnPositionOrYaw) {
  // This is why the velocity is kept in body axes: turning and moving the odom frame changes no prediction.
  const ErrorMatrix F = transition(state_, imu_, 0.01);
  ErrorVector turn = ErrorVector::Zero();
  turn.segment<3>(kAttitude) = state_.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((F * turn).segment<3>(kVelocity).norm(), 1e-12);
}

TEST_F(Models, WheelJacobianMatches) {
  const Geometry geometry(vehicle_);
  for (const Wheel wheel : {Wheel::kLeft, Wheel::kRight}) {
    expect_jacobian_matches([&](const NavState& x) {
      return observe_wheel(x, body_motion(x, imu_.angular_rate, geometry), wheel, 2.0, 0.1, geometry);
    });
  }
}

TEST_F(Models, ForwardSpeedJacobianMatchesWhereTheGyroIsNotUsed) {
  expect_jacobian_matches([&](const NavState& x) {
    return observe_forward_speed(x, {x.velocity, Eigen::Vector3d::Zero()}, 2.0, 0.1);
  });
}

TEST_F(Models, ConstraintJacobianMatches) {
  const Geometry geometry(vehicle_);
  for (const int axis : {1, 2}) {
    expect_jacobian_matches([&](NavState x) {
      if (axis == 2) x.axle = state_.axle;
      return observe_no_motion_along(axis, x, body_motion(x, imu_.angular_rate, geometry), 0.1, geometry);
    });
  }
}

TEST_F(Models, WhereTheAxleIsShowsInTurnsAndNotInPitching) {
  const BodyMotion motion{{3.0, 0.0, 0.0}, {0.1, 0.2, 0.4}};
  const Geometry geometry(vehicle_);
  EXPECT_DOUBLE_EQ(observe_no_motion_along(1, state_, motion, 1, geometry).H(0, kAxle), 0.4);
  EXPECT_EQ(observe_no_motion_along(2, state_, motion, 1, geometry).H(0, kAxle), 0.0);
}

TEST_F(Models, TheAxleIsWhatDoesNotMoveSideways) {
  // Round a circle about (0, 2) of base_link's frame with the axle 0.76 m behind: base_link itself moves to the left.
  vehicle_.imu = {0, 0, 0, 0, 0, 0};
  const Geometry geometry(vehicle_);
  NavState x;
  x.axle = -0.76;
  const BodyMotion motion{{1.0, 0.5 * 0.76, 0}, {0, 0, 0.5}};
  EXPECT_NEAR(observe_no_motion_along(1, x, motion, 1, geometry).residual[0], 0.0, 1e-12);
}

TEST_F(Models, ACourseThatIsNotAlongXIsNoMotionOffTheCourse) {
  const Geometry geometry(vehicle_);
  NavState x;
  x.course << 0.01, -0.02;
  const BodyMotion motion{{3.0, 0.03, -0.06}, Eigen::Vector3d::Zero()};
  for (const int axis : {1, 2})
    EXPECT_NEAR(observe_no_motion_along(axis, x, motion, 1, geometry).residual[0], 0.0, 1e-12);
}

TEST_F(Models, IncrementJacobianMatchesUpToTheBendWithinIt) {
  const Geometry geometry(vehicle_);
  const double dt = 0.5;
  imu_.angular_rate << 0.05, -0.03, 0.4;
  const auto increment = [&](const NavState& x) {
    const BodyMotion motion = body_motion(x, imu_.angular_rate, geometry);
    Pose T = Pose::Identity();
    const int n = 200;
    for (int i = 0; i < n; ++i) {
      const Eigen::Matrix3d half = so3_exp(motion.angular_rate * (0.5 * dt / n)).toRotationMatrix();
      T.translation() += T.linear() * (half * motion.velocity) * (dt / n);
      T.linear() = (T.linear() * half * half).eval();
    }
    return T;
  };
  const Pose measured = increment(state_);
  const BodyMotion motion = body_motion(state_, imu_.angular_rate, geometry);
  const auto observe = [&](const NavState& x) {
    return observe_increment(measured, Eigen::Matrix<double, 6, 6>::Identity(), increment(x), dt, motion, geometry);
  };
  const Eigen::MatrixXd expected =
      numeric([&](const ErrorVector& e) -> Eigen::VectorXd { return -observe(plus(state_, e)).residual; });
  EXPECT_LT(observe(state_).residual.norm(), 1e-12);
  EXPECT_LT((observe(state_).H - expected).cwiseAbs().maxCoeff(), 0.05 * dt) << observe(state_).H - expected;
}

TEST_F(Models, StandingAndGravityJacobiansMatch) {
  expect_jacobian_matches([&](const NavState& x) { return observe_standing_velocity(x, 0.1); });
  expect_jacobian_matches([&](const NavState& x) { return observe_standing_rate(x, imu_.angular_rate, 0.1); });
  expect_jacobian_matches([&](const NavState& x) {
    return observe_gravity(x, imu_.acceleration, {0.1, 0.2, 0.3}, 0.1);
  });
}

TEST_F(Models, WheelsOfADifferentialDriveTurnAsTheReferenceSays) {
  // protocols/kalman_odometry.md section 2: v_L = v - w b/2, v_R = v + w b/2
  vehicle_.imu = {0, 0, 0, 0, 0, 0};
  vehicle_.track_width = 0.4;
  const Geometry geometry(vehicle_);
  const NavState x;
  const BodyMotion motion{{1.0, 0, 0}, {0, 0, 0.5}};
  EXPECT_NEAR(observe_wheel(x, motion, Wheel::kLeft, 0.9, 1, geometry).residual[0], 0.0, 1e-12);
  EXPECT_NEAR(observe_wheel(x, motion, Wheel::kRight, 1.1, 1, geometry).residual[0], 0.0, 1e-12);
}

TEST_F(Models, CorrectionEqualsTheInformationForm) {
  const ErrorMatrix A = ErrorMatrix::Random();
  Belief belief;
  belief.covariance = A * A.transpose() + ErrorMatrix::Identity();
  const ErrorMatrix prior = belief.covariance;
  const Observation z = observe_standing_velocity(state_, 0.3);
  correct(belief, z, optimal_gain(belief, z));
  const ErrorMatrix expected = (prior.inverse() + z.H.transpose() * z.R.inverse() * z.H).inverse();
  EXPECT_LT((belief.covariance - expected).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ((belief.covariance - belief.covariance.transpose()).cwiseAbs().maxCoeff(), 0.0);
}

TEST_F(Models, TheGuardedGainMovesThePositionByTheGyrosBiasAlone) {
  Belief belief;
  belief.mean = state_;
  belief.covariance.setIdentity();
  belief.covariance.block<3, 3>(kPosition, kVelocity).setConstant(0.2);  // as if a scale were learnt
  belief.covariance.block<3, 3>(kVelocity, kPosition).setConstant(0.2);
  Observation z = observe_standing_velocity(state_, 0.3);
  z.residual << 1e-3, -2e-3, 3e-3;
  correct(belief, z, guarded_gain(belief, z));
  EXPECT_EQ(belief.mean.position, state_.position);
  EXPECT_GT((belief.mean.velocity - state_.velocity).norm(), 1e-3);

  Belief turned;  // a bias that is exactly known to have moved it
  turned.mean.attitude.setIdentity();
  turned.covariance.setIdentity();
  turned.covariance(kPosition + 1, kGyroBias + 2) = turned.covariance(kGyroBias + 2, kPosition + 1) = 0.9;
  Observation rate = observe_standing_rate(turned.mean, Eigen::Vector3d(0, 0, 0.01), 1e-4);
  const Gain guarded = guarded_gain(turned, rate);
  EXPECT_LT((guarded - optimal_gain(turned, rate)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(Models, AnOutlierLosesItsWeightButNotItsDirection) {
  Belief belief;
  belief.covariance.setIdentity();
  Observation z(1);
  z.H(0, kVelocity) = 1.0;
  z.R(0, 0) = 1.0;
  z.residual[0] = 1.0;
  Observation far = z;
  far.residual[0] = 100.0;
  EXPECT_TRUE(soften_beyond(kGate1, belief, z));
  EXPECT_FALSE(soften_beyond(kGate1, belief, far));
  EXPECT_EQ(z.R(0, 0), 1.0);
  EXPECT_GT(far.R(0, 0), 100.0);
}

}  // namespace
}  // namespace curbstone
