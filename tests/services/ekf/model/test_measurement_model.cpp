#include "services/ekf/model/measurement_model.hpp"

#include <gtest/gtest.h>

#include "tests/services/ekf/model/model_fixture.hpp"

namespace curbstone::ekf::model {
namespace {

using MeasurementModelTest = ModelTest;

TEST_F(MeasurementModelTest, WheelJacobianMatches) {
  const Geometry geometry(vehicle_);
  for (const Wheel wheel : {Wheel::kLeft, Wheel::kRight}) {
    expect_jacobian_matches([&](const NavState& x) {
      return observe_wheel(x, body_motion(x, imu_.angular_rate, geometry), wheel, 2.0, 0.1, geometry);
    });
  }
}

TEST_F(MeasurementModelTest, ForwardSpeedJacobianMatchesWhereTheGyroIsNotUsed) {
  expect_jacobian_matches([&](const NavState& x) {
    return observe_forward_speed(x, {x.velocity, Eigen::Vector3d::Zero()}, 2.0, 0.1);
  });
}

TEST_F(MeasurementModelTest, ConstraintJacobianMatches) {
  const Geometry geometry(vehicle_);
  for (const int axis : {1, 2}) {
    expect_jacobian_matches([&](NavState x) {
      if (axis == 2) x.axle = state_.axle;
      return observe_no_motion_along(axis, x, body_motion(x, imu_.angular_rate, geometry), 0.1, geometry);
    });
  }
}

TEST_F(MeasurementModelTest, WhereTheAxleIsShowsInTurnsAndNotInPitching) {
  const BodyMotion motion{{3.0, 0.0, 0.0}, {0.1, 0.2, 0.4}};
  const Geometry geometry(vehicle_);
  EXPECT_DOUBLE_EQ(observe_no_motion_along(1, state_, motion, 1, geometry).H(0, kAxle), 0.4);
  EXPECT_EQ(observe_no_motion_along(2, state_, motion, 1, geometry).H(0, kAxle), 0.0);
}

TEST_F(MeasurementModelTest, TheAxleIsWhatDoesNotMoveSideways) {
  // Round a circle about (0, 2) of base_link's frame with the axle 0.76 m behind: base_link itself moves to the left.
  vehicle_.imu = {0, 0, 0, 0, 0, 0};
  const Geometry geometry(vehicle_);
  NavState x;
  x.axle = -0.76;
  const BodyMotion motion{{1.0, 0.5 * 0.76, 0}, {0, 0, 0.5}};
  EXPECT_NEAR(observe_no_motion_along(1, x, motion, 1, geometry).residual[0], 0.0, 1e-12);
}

TEST_F(MeasurementModelTest, ACourseThatIsNotAlongXIsNoMotionOffTheCourse) {
  const Geometry geometry(vehicle_);
  NavState x;
  x.course << 0.01, -0.02;
  const BodyMotion motion{{3.0, 0.03, -0.06}, Eigen::Vector3d::Zero()};
  for (const int axis : {1, 2})
    EXPECT_NEAR(observe_no_motion_along(axis, x, motion, 1, geometry).residual[0], 0.0, 1e-12);
}

TEST_F(MeasurementModelTest, IncrementJacobianMatchesUpToTheBendWithinIt) {
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

TEST_F(MeasurementModelTest, StandingAndGravityJacobiansMatch) {
  expect_jacobian_matches([&](const NavState& x) { return observe_standing_velocity(x, 0.1); });
  expect_jacobian_matches([&](const NavState& x) { return observe_standing_rate(x, imu_.angular_rate, 0.1); });
  expect_jacobian_matches([&](const NavState& x) {
    return observe_gravity(x, imu_.acceleration, {0.1, 0.2, 0.3}, 0.1);
  });
}

TEST_F(MeasurementModelTest, WheelsOfADifferentialDriveTurnAsTheReferenceSays) {
  // differential drive, inverse kinematics: v_L = v - w b/2, v_R = v + w b/2
  vehicle_.imu = {0, 0, 0, 0, 0, 0};
  vehicle_.track_width = 0.4;
  const Geometry geometry(vehicle_);
  const NavState x;
  const BodyMotion motion{{1.0, 0, 0}, {0, 0, 0.5}};
  EXPECT_NEAR(observe_wheel(x, motion, Wheel::kLeft, 0.9, 1, geometry).residual[0], 0.0, 1e-12);
  EXPECT_NEAR(observe_wheel(x, motion, Wheel::kRight, 1.1, 1, geometry).residual[0], 0.0, 1e-12);
}

}  // namespace
}  // namespace curbstone::ekf::model
