#include "services/ekf/model/correction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/services/ekf/model/model_fixture.hpp"

namespace curbstone::ekf::model {
namespace {

using CorrectionTest = ModelTest;

TEST_F(CorrectionTest, CorrectionEqualsTheInformationForm) {
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

TEST_F(CorrectionTest, EveryNumberOfRowsIsCorrectedByJosephsForm) {
  const ErrorMatrix A = ErrorMatrix::Random();
  Belief prior;
  prior.mean = state_;
  prior.covariance = A * A.transpose() + ErrorMatrix::Identity();
  const ErrorMatrix& P = prior.covariance;
  for (int rows = 1; rows <= Observation::kMaxRows; ++rows) {
    Observation z(rows);
    z.residual.setRandom();
    z.H.setRandom();
    z.H.middleCols<3>(kVelocity).setZero();
    z.R.setRandom();
    z.R = (z.R * z.R.transpose()).eval();
    const Eigen::MatrixXd S = z.H * P * z.H.transpose() + z.R;
    const Gain K = P * z.H.transpose() * S.inverse();
    EXPECT_LT((optimal_gain(prior, z) - K).cwiseAbs().maxCoeff(), 1e-9) << rows;
    EXPECT_NEAR(squared_mahalanobis(prior, z), z.residual.dot(S.inverse() * z.residual), 1e-9);

    const Gain any = 0.5 * K;  // Joseph's form is for every gain
    Belief belief = prior;
    correct(belief, z, any);
    const ErrorMatrix I_KH = ErrorMatrix::Identity() - any * z.H;
    const ErrorMatrix expected = I_KH * P * I_KH.transpose() + any * z.R * any.transpose();
    EXPECT_LT((belief.covariance - expected).cwiseAbs().maxCoeff(), 1e-9) << rows;
    EXPECT_LT((minus(belief.mean, state_) - any * z.residual).norm(), 1e-9) << rows;
  }
}

TEST_F(CorrectionTest, TheGuardedGainMovesThePositionByTheGyrosBiasAlone) {
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

TEST_F(CorrectionTest, AnOutlierLosesItsWeightButNotItsDirection) {
  Belief belief;
  belief.covariance.setIdentity();
  Observation z(1);
  z.H(0, kVelocity) = 1.0;
  z.R(0, 0) = 1.0;
  z.residual[0] = 1.0;
  Observation far = z;
  far.residual[0] = 100.0;
  EXPECT_TRUE(inflate_noise_beyond(kGate1, belief, z));
  EXPECT_FALSE(inflate_noise_beyond(kGate1, belief, far));
  EXPECT_EQ(z.R(0, 0), 1.0);
  EXPECT_DOUBLE_EQ(far.R(0, 0), 100.0 * 100.0 / 2.0 / kGate1) << "the distance over the gate, with S = 2";
}

TEST_F(CorrectionTest, TheGatesAreQuantilesOfChiSquare) {
  const double half1 = kGate1 / 2, half3 = kGate3 / 2, half6 = kGate6 / 2;
  EXPECT_NEAR(std::erf(std::sqrt(half1)), 0.999, 2e-6);
  EXPECT_NEAR(std::erf(std::sqrt(half3)) - 2 * std::sqrt(half3 / M_PI) * std::exp(-half3), 0.999, 2e-6);
  EXPECT_NEAR(1 - std::exp(-half6) * (1 + half6 + half6 * half6 / 2), 0.999, 2e-6);
}

}  // namespace
}  // namespace curbstone::ekf::model
