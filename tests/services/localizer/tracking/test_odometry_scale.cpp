#include "services/localizer/tracking/odometry_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/linear/decompositions.hpp"

namespace curbstone::localizer::tracking {
namespace {

constexpr double kStep = 0.5;  // m a revolution

/// A filter of pose and scale on a straight drive whose odometry measures `scale` too little.
class StraightDrive {
 public:
  StraightDrive(double scale, unsigned seed) : scale_(scale), random_(seed) {
    belief_.covariance = 1e-4 * Matrix6::Identity();
  }
  /// With walls the place is measured to 2 cm.
  void revolution(bool with_walls) {
    Motion odometry;
    odometry.T_last_base.translation().x() = kStep + 0.005 * normal_(random_);
    odometry.seconds = 0.05;
    truth_ += kStep * (1 + scale_);
    const Motion motion = estimate_.corrected(odometry);
    const PoseBelief next = estimate_.predict(belief_, motion, predicted(belief_, motion, {}));
    belief_ = next;
    if (!with_walls) return;
    constexpr double kSigma = 0.02;
    Matrix6 information = inverse(next.covariance);
    information(0, 0) += 1 / (kSigma * kSigma);
    belief_.covariance = inverse(information);
    const double off = truth_ + kSigma * normal_(random_) - next.T_map_base.translation().x();
    belief_.T_map_base = moved_by(next.T_map_base, belief_.covariance.col(0) / (kSigma * kSigma) * off);
    estimate_.update(next, belief_);
  }
  [[nodiscard]] double error() const { return belief_.T_map_base.translation().x() - truth_; }
  [[nodiscard]] double sigma() const { return std::sqrt(belief_.covariance(0, 0)); }
  [[nodiscard]] const OdometryScale& estimate() const { return estimate_; }
  [[nodiscard]] const PoseBelief& belief() const { return belief_; }

 private:
  double scale_, truth_ = 0;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  PoseBelief belief_;
  OdometryScale estimate_;
};

TEST(OdometryScale, IsLearnedWhereWallsShowTheWayAndHoldsWhereNoneStand) {
  StraightDrive drive(0.008, 1);
  for (int i = 0; i < 400; ++i) drive.revolution(true);
  EXPECT_NEAR(drive.estimate().value(), 0.008, 0.004);
  for (int i = 0; i < 80; ++i) drive.revolution(false);
  EXPECT_LT(std::abs(drive.error()), 0.15) << "0.32 m by odometry alone, after 40 m";
}

TEST(OdometryScale, TheErrorOfAStreetWithoutWallsIsAsLargeAsItsCovarianceSays) {
  double squares = 0;
  constexpr int kDrives = 200;
  for (unsigned i = 0; i < kDrives; ++i) {
    StraightDrive drive(0.01 * (i % 21 - 10.0) / 6.0, i + 1);  // uniform: sigma 0.01
    for (int k = 0; k < 200; ++k) drive.revolution(false);
    squares += std::pow(drive.error() / drive.sigma(), 2);
  }
  EXPECT_GT(squares / kDrives, 0.4);
  EXPECT_LT(squares / kDrives, 1.4);
}

/// One revolution, after which the map puts the vehicle `off` m ahead.
class OneRevolution {
 public:
  OneRevolution(bool with_odometry, double off) {
    motion_.with_odometry = with_odometry;
    motion_.T_last_base.translation().x() = kStep;
    predicted_ = predicted(before_, motion_, {});
    corrected_ = predicted_;
    corrected_.T_map_base.translation().x() += off;
    corrected_.covariance *= 0.5;
  }
  void predict(OdometryScale& scale) { predicted_ = scale.predict(before_, motion_, predicted_); }
  void update(OdometryScale& scale) const { scale.update(predicted_, corrected_); }
  void make_singular() { predicted_.covariance.setZero(); }

 private:
  Motion motion_;
  PoseBelief before_, predicted_, corrected_;
};

TEST(OdometryScale, WithoutOdometryNothingIsLearned) {
  OdometryScale scale;
  OneRevolution blind(false, 0.3);
  blind.predict(scale);
  blind.update(scale);
  EXPECT_EQ(scale.value(), 0);
}

TEST(OdometryScale, WheelsThatSlipChangeItByAFewPercentOnlyAndASingularCovarianceNotAtAll) {
  OdometryScale scale;
  OneRevolution slip(true, 1e4);
  slip.predict(scale);
  slip.update(scale);
  const double value = scale.value();
  EXPECT_EQ(value, 0.05);
  slip.make_singular();
  slip.update(scale);
  EXPECT_EQ(scale.value(), value);
  EXPECT_TRUE(std::isfinite(scale.sigma()));
}

TEST(OdometryScale, LeavesTheCovarianceOfALostPosePositive) {
  StraightDrive drive(0.01, 3);
  for (int i = 0; i < 100; ++i) drive.revolution(true);
  for (int i = 0; i < 5000; ++i) drive.revolution(false);
  EXPECT_GT(eigen_pairs<6>(drive.belief().covariance).values(0), 0);
  EXPECT_LT(drive.sigma(), 10);
  for (int i = 0; i < 50; ++i) drive.revolution(true);
  EXPECT_LT(std::abs(drive.error()), 0.1);
  EXPECT_NEAR(drive.estimate().value(), 0.01, 0.005) << "what was learnt while lost is no more than the pose tells";
}

}  // namespace
}  // namespace curbstone::localizer::tracking
