#include "services/mapper/tracking/acceptance.hpp"

#include <gtest/gtest.h>

namespace curbstone::mapper::tracking {
namespace {

using registration::Matrix6;

/// A fit that is believed, until a test spoils it.
Fit good_fit() {
  Fit fit;
  fit.prediction.with_odometry = true;
  fit.prediction.covariance = 1e-4 * Matrix6::Identity();
  fit.result.converged = true;
  fit.result.overlap = 0.9;
  fit.result.inlier_ratio = 0.95;
  fit.result.residual = 0.02;
  return fit;
}

std::string why(const Fit& fit, Certainty guess = Certainty::kFollowed, const Matrix6& drift = Matrix6::Zero()) {
  return why_refused(fit, config::TrackerConfig{}, drift, guess);
}

TEST(Acceptance, AGoodFitIsBelieved) {
  EXPECT_EQ(why(good_fit()), "");
  EXPECT_EQ(why(good_fit(), Certainty::kGuessed), "");
}

TEST(Acceptance, EachWeaknessHasItsOwnCounter) {
  Fit fit = good_fit();
  fit.result.converged = false;
  EXPECT_EQ(why(fit), "refused.not_converged");
  fit = good_fit();
  fit.result.overlap = 0.05;
  EXPECT_EQ(why(fit), "refused.overlap");
  fit = good_fit();
  fit.result.inlier_ratio = 0.5;
  EXPECT_EQ(why(fit), "refused.inliers");
  fit = good_fit();
  fit.result.residual = 0.2;
  EXPECT_EQ(why(fit), "refused.residual");
}

TEST(Acceptance, MoreMustFitWhereTheGuessIsNotSureToBeNear) {
  Fit fit = good_fit();
  fit.result.overlap = 0.3;
  EXPECT_EQ(why(fit), "");
  EXPECT_EQ(why(fit, Certainty::kFound), "") << "it was found, and may have left the map's end behind";
  EXPECT_EQ(why(fit, Certainty::kGuessed), "refused.overlap");
  fit = good_fit();
  fit.result.degenerate = registration::kPlanarAxes;
  EXPECT_EQ(why(fit), "");
  EXPECT_EQ(why(fit, Certainty::kGuessed), "refused.inliers");
}

TEST(Acceptance, AJumpIsBelievedAsFarAsOdometryAndDriftAllow) {
  Fit fit = good_fit();
  fit.result.T_map_base.translation().x() = 0.6;  // 0.5 m and 3 sigma of 1 cm are allowed
  EXPECT_EQ(why(fit), "refused.jump");
  EXPECT_EQ(why(fit, Certainty::kFollowed, 0.01 * Matrix6::Identity()), "") << "it may have drifted by 3 x 10 cm";
  fit.result.T_map_base.translation().x() = 0.4;
  EXPECT_EQ(why(fit), "");
  fit.prediction.with_odometry = false;
  EXPECT_EQ(why(fit), "refused.jump");
}

}  // namespace
}  // namespace curbstone::mapper::tracking
