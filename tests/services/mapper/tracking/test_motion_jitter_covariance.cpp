#include "services/mapper/tracking/motion_jitter_covariance.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr double kStride = 0.1;  // s

/// Poses of a steady drive, each off by a draw of its own.
std::vector<Pose> drive(const registration::Vector6& sigma, int poses) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<Pose> out;
  for (int i = 0; i < poses; ++i) {
    registration::Vector6 error;
    for (int k = 0; k < 6; ++k) error[k] = sigma[k] * normal(random);
    out.push_back(scan::move({{5, 0, 0}, {0, 0, 0.2}}, i * kStride) * registration::exp_of(error));
  }
  return out;
}

MotionJitterCovariance watched(const std::vector<Pose>& poses) {
  MotionJitterCovariance out;
  for (std::size_t i = 2; i < poses.size(); ++i) {
    out.add(scan::twist_of(poses[i - 2].inverse() * poses[i - 1], kStride),
            scan::twist_of(poses[i - 1].inverse() * poses[i], kStride), kStride);
  }
  return out;
}

TEST(MotionJitterCovarianceTest, IsTheErrorOfThePosesWhereThatIsDrawnAnewEachTime) {
  registration::Vector6 sigma;
  sigma << 0.01, 0.02, 0.03, 1e-3, 2e-3, 5e-4;
  const std::vector<Pose> poses = drive(sigma, 2000);
  registration::Vector6 mean = registration::Vector6::Zero();
  int looks = 0;
  for (std::size_t end = 100; end <= poses.size(); end += 50, ++looks) {
    mean += watched({poses.begin() + static_cast<std::ptrdiff_t>(end) - 100,
                     poses.begin() + static_cast<std::ptrdiff_t>(end)})
                .covariance()
                .diagonal();
  }
  mean /= looks;
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(std::sqrt(mean[k]) / sigma[k], 1, 0.15) << k;
}

TEST(MotionJitterCovarianceTest, OfASteadyDriveComesToNothing) {
  EXPECT_LT(watched(drive(registration::Vector6::Zero(), 300)).covariance().norm(), 1e-9);
}

TEST(MotionJitterCovarianceTest, CoversAMotionThatChanges) {
  // Pitch to and fro, twice a second: steady motion foresees the end of a revolution wrongly.
  std::vector<Pose> poses;
  const auto pitch = [](double t) { return 5e-3 * std::sin(4 * 3.14159265 * t); };
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    const double t = i * kStride;
    registration::Vector6 turn = registration::Vector6::Zero();
    turn[4] = pitch(t);
    poses.push_back(registration::exp_of(turn));
    const double foreseen = pitch(t) + 0.5 * (pitch(t) - pitch(t - kStride));  // half a revolution on
    worst = std::max(worst, std::abs(foreseen - pitch(t + 0.5 * kStride)));
  }
  const double claimed = std::sqrt(watched(poses).covariance()(4, 4));
  EXPECT_GT(claimed, 0.5 * worst);
  EXPECT_LT(claimed, 2 * worst);
}

TEST(MotionJitterCovarianceTest, DoesNotPretendBeforeItHasSeenAnything) {
  EXPECT_GT(std::sqrt(MotionJitterCovariance().covariance()(0, 0)), 0.01);
  EXPECT_GT(std::sqrt(MotionJitterCovariance().covariance()(4, 4)), 1e-3);
}

}  // namespace
}  // namespace curbstone::mapper::tracking
