#include "services/ekf/model/error_state.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/services/ekf/model/model_fixture.hpp"

namespace curbstone::ekf::model {
namespace {

using ErrorStateTest = ModelTest;

TEST_F(ErrorStateTest, MinusUndoesPlus) {
  ErrorVector error = ErrorVector::Random() * 0.5;
  EXPECT_LT((minus(plus(state_, error), state_) - error).norm(), 1e-12);
}

TEST_F(ErrorStateTest, ThePropagatedCovarianceIsTheProduct) {
  const ErrorMatrix A = ErrorMatrix::Random();
  const ErrorMatrix P = A * A.transpose();
  ErrorMatrix J = ErrorMatrix::Random();
  const ErrorMatrix expected = J * P * J.transpose();
  EXPECT_LT((propagated(J, P) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
  J = transition(state_, imu_, 0.01);  // mostly zeros
  EXPECT_LT((propagated(J, P) - J * P * J.transpose()).cwiseAbs().maxCoeff(), 1e-12 * P.cwiseAbs().maxCoeff());
  const Eigen::Matrix<double, 6, kErrorSize> top = J.topRows<6>();
  EXPECT_EQ(propagated(top, P), (propagated(J, P).topLeftCorner<6, 6>()));
}

TEST_F(ErrorStateTest, TheTransitionChangesTheMotionAlone) {
  const ErrorMatrix A = ErrorMatrix::Random();
  ErrorMatrix P = A * A.transpose();
  P = (0.5 * (P + P.transpose())).eval();
  const ErrorMatrix F = transition(state_, imu_, 0.01);
  const ErrorMatrix expected = propagated(F, P);
  propagate_motion(F, P);
  EXPECT_EQ(P, expected);
}

TEST_F(ErrorStateTest, WhatIsNotFiniteStaysSo) {
  ErrorMatrix P = ErrorMatrix::Identity();
  P(kCourse, kCourse) = std::numeric_limits<double>::quiet_NaN();
  const ErrorMatrix F = transition(state_, imu_, 0.01);
  EXPECT_FALSE(propagated(F, P).allFinite());
  propagate_motion(F, P);
  EXPECT_FALSE(P.allFinite());
}

}  // namespace
}  // namespace curbstone::ekf::model
