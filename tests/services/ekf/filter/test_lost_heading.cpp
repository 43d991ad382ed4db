#include "services/ekf/filter/lost_heading.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/geometry.hpp"
#include "services/ekf/model/measurement_model.hpp"

namespace curbstone::ekf::filter {
namespace {

constexpr double kTilt = 0.1;          // rad, by which the filter is wrong about its pitch
constexpr double kHeadingSigma = 0.7;  // rad

/// It believes to stand on a slope, knows the tilt badly, and its heading not at all.
model::Belief belief_on_a_slope() {
  model::Belief belief;
  belief.mean.attitude = Eigen::Quaterniond(rotation_from_rpy(0.0, 0.3, 0.5));
  const Eigen::Vector3d up = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  belief.covariance.diagonal().setConstant(1e-6);
  belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) +=
      kTilt * kTilt * Eigen::Matrix3d::Identity() + kHeadingSigma * kHeadingSigma * up * up.transpose();
  return belief;
}

double heading_sigma(const model::Belief& belief) {
  const Eigen::Vector3d up = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  return std::sqrt(up.dot(belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) * up));
}

/// Gravity says that it is level.
void level(const LostHeading& heading, model::Belief& belief) {
  for (int i = 0; i < 20; ++i) {
    const model::Observation z =
        model::observe_gravity(belief.mean, Eigen::Vector3d(0, 0, kGravity), Eigen::Vector3d::Zero(), 0.05);
    heading.correct(belief, z, model::optimal_gain(belief, z));
  }
}

TEST(LostHeadingTest, ACorrectionOfTheTiltMakesNoLostHeadingKnown) {
  model::Belief belief = belief_on_a_slope();
  const double before = heading_sigma(belief);
  LostHeading heading;
  heading.lose();
  level(heading, belief);
  EXPECT_NEAR(roll_pitch_yaw(belief.mean.attitude.toRotationMatrix()).y(), 0.0, 0.01);
  EXPECT_GE(heading_sigma(belief), before * (1 - 1e-9));
  EXPECT_LT(heading_sigma(belief), before * 1.01) << "nor less known";
}

TEST(LostHeadingTest, WithoutALossACorrectionIsTheModels) {
  model::Belief belief = belief_on_a_slope();
  model::Belief models = belief;
  level(LostHeading(), belief);
  for (int i = 0; i < 20; ++i) {
    const model::Observation z =
        model::observe_gravity(models.mean, Eigen::Vector3d(0, 0, kGravity), Eigen::Vector3d::Zero(), 0.05);
    model::correct(models, z, model::optimal_gain(models, z));
  }
  EXPECT_EQ(belief.covariance, models.covariance);
  EXPECT_LT(heading_sigma(belief), 0.6 * kHeadingSigma) << "what the class is for";
}

TEST(LostHeadingTest, ThePlaceIsLostWithTheWayAndNotBeforeTheHeadingIs) {
  model::Belief belief = belief_on_a_slope();
  const model::Belief before = belief;
  LostHeading heading;
  heading.propagate(belief, 10.0);
  EXPECT_EQ(belief.covariance, before.covariance);

  heading.lose();
  EXPECT_TRUE(heading.lost());
  for (int i = 0; i < 10; ++i) heading.propagate(belief, i % 2 == 0 ? 1.0 : -1.0);
  const double variance = heading_sigma(before) * heading_sigma(before);
  const double expected = 0.5 * variance * 10.0;  // 1 - cos of the heading's error, of the way
  EXPECT_NEAR(std::sqrt(belief.covariance(0, 0)), expected, 0.01 * expected);
  EXPECT_NEAR(std::sqrt(belief.covariance(1, 1)), expected, 0.01 * expected);
  EXPECT_EQ(belief.covariance(2, 2), before.covariance(2, 2));
}

}  // namespace
}  // namespace curbstone::ekf::filter
