#include "services/ekf/filter/odom_smoother.hpp"

#include <gtest/gtest.h>

namespace curbstone::ekf::filter {
namespace {

Pose pose(double x, double y, double z, double yaw) {
  Pose T = Pose::Identity();
  T.linear() = rotation_from_rpy(0.02, -0.03, yaw);
  T.translation() << x, y, z;
  return T;
}

model::Estimate at(const Pose& T_odom_base) {
  model::Estimate e;
  e.T_odom_base = T_odom_base;
  e.pose_covariance.setIdentity();
  return e;
}

class OdomSmootherTest : public ::testing::Test {
 protected:
  [[nodiscard]] Pose published() const {
    model::Estimate e = at(believed_);
    smoother_.apply(e);
    return e.T_odom_base;
  }
  void correct_to(const Pose& T) {
    smoother_.corrected(believed_, T);
    believed_ = T;
  }
  void drive(double metres, double seconds) {
    believed_ = believed_ * Eigen::Translation3d(metres, 0, 0);
    smoother_.moved(believed_, metres, seconds);
  }

  base::SpreadConfig config_{.share = 0.05, .turning = 0.01};
  OdomSmoother smoother_{config_};
  Pose believed_ = pose(10, 5, 0.5, 0.3);
};

TEST_F(OdomSmootherTest, WithoutCorrectionsItPublishesTheBelief) {
  drive(1.0, 0.5);
  EXPECT_TRUE(published().isApprox(believed_, 1e-12));
}

TEST_F(OdomSmootherTest, ACorrectionDoesNotShowAtOnce) {
  const Pose before = published();
  correct_to(pose(12, 4, 0.3, 0.5));
  EXPECT_TRUE(published().isApprox(before, 1e-12));
}

TEST_F(OdomSmootherTest, ATiltIsTakenAtOnce) {
  Pose level = Pose::Identity();
  level.linear() = rotation_from_rpy(0, 0, 0.3);
  level.translation() = believed_.translation();
  correct_to(level);
  EXPECT_LT(roll_pitch_yaw(published().linear()).head<2>().norm(), 1e-3);
}

TEST_F(OdomSmootherTest, ItIsMadeUpForAtTheConfiguredPaceAndThenAllOfIt) {
  correct_to(pose(12, 4, 0.3, 0.4));
  Pose last = published();
  for (int i = 0; i < 800; ++i) {
    drive(0.15, 0.05);
    const Pose step = last.inverse() * published();
    EXPECT_LE((step.translation() - Eigen::Vector3d(0.15, 0, 0)).norm(), 0.05 * 0.15 + 1e-4);
    EXPECT_LE(std::abs(roll_pitch_yaw(step.linear()).z()), 0.01 * 0.05 + 1e-9);
    last = published();
  }
  EXPECT_TRUE(published().isApprox(believed_, 1e-9));
}

TEST_F(OdomSmootherTest, StandingItMakesUpForNothing) {
  correct_to(pose(12, 4, 0.3, 0.4));
  const Pose before = published();
  smoother_.moved(believed_, 0.0, 10.0);
  EXPECT_TRUE(published().isApprox(before, 1e-12));
}

TEST_F(OdomSmootherTest, TheCovarianceCoversWhatIsHeldBack) {
  const Pose before = believed_;
  correct_to(pose(13, 5, 0.5, 0.5));
  model::Estimate e = at(believed_);
  smoother_.apply(e);
  const Eigen::Vector3d far = before.translation() - believed_.translation();
  EXPECT_NEAR(e.pose_covariance(0, 0), 1.0 + far.x() * far.x(), 1e-9);
  EXPECT_NEAR(e.pose_covariance(5, 5), 1.0 + 0.2 * 0.2, 1e-3);
}

TEST_F(OdomSmootherTest, TheUncorrectedPathKnowsNeitherOfCorrectionsNorOfMakingUp) {
  const Pose begin = smoother_.uncorrected(believed_);
  drive(1.0, 0.4);
  correct_to(pose(12, 4, 0.3, 0.4));
  drive(1.0, 0.4);
  const Pose moved = begin.inverse() * smoother_.uncorrected(believed_);
  EXPECT_NEAR(moved.translation().x(), 2.0, 2e-3);
  EXPECT_LT(moved.translation().tail<2>().norm(), 0.02);  // the tilt that the correction left in place
}

}  // namespace
}  // namespace curbstone::ekf::filter
