#include "services/mapper/unsteadiness.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "services/mapper/normal_equations.hpp"

namespace curbstone {
namespace {

constexpr double kStride = 0.1;  // s

/// Poses of a steady drive, each off by a draw of its own.
std::vector<Pose> drive(const Vector6& sigma, int poses) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<Pose> out;
  for (int i = 0; i < poses; ++i) {
    Vector6 error;
    for (int k = 0; k < 6; ++k) error[k] = sigma[k] * normal(random);
    out.push_back(move({{5, 0, 0}, {0, 0, 0.2}}, i * kStride) * exp_of(error));
  }
  return out;
}

Unsteadiness watched(const std::vector<Pose>& poses) {
  Unsteadiness out;
  for (std::size_t i = 2; i < poses.size(); ++i) {
    out.add(twist_of(poses[i - 2].inverse() * poses[i - 1], kStride),
            twist_of(poses[i - 1].inverse() * poses[i], kStride), kStride);
  }
  return out;
}

TEST(UnsteadinessTest, IsTheErrorOfThePosesWhereThatIsDrawnAnewEachTime) {
  Vector6 sigma;
  sigma << 0.01, 0.02, 0.03, 1e-3, 2e-3, 5e-4;
  const std::vector<Pose> poses = drive(sigma, 2000);
  Vector6 mean = Vector6::Zero();
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

TEST(UnsteadinessTest, OfASteadyDriveComesToNothing) {
  EXPECT_LT(watched(drive(Vector6::Zero(), 300)).covariance().norm(), 1e-9);
}

TEST(UnsteadinessTest, CoversAMotionThatChanges) {
  // Pitch to and fro, twice a second: steady motion foresees the end of a revolution wrongly.
  std::vector<Pose> poses;
  const auto pitch = [](double t) { return 5e-3 * std::sin(4 * 3.14159265 * t); };
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    const double t = i * kStride;
    Vector6 turn = Vector6::Zero();
    turn[4] = pitch(t);
    poses.push_back(exp_of(turn));
    const double foreseen = pitch(t) + 0.5 * (pitch(t) - pitch(t - kStride));  // half a revolution on
    worst = std::max(worst, std::abs(foreseen - pitch(t + 0.5 * kStride)));
  }
  const double claimed = std::sqrt(watched(poses).covariance()(4, 4));
  EXPECT_GT(claimed, 0.5 * worst);
  EXPECT_LT(claimed, 2 * worst);
}

TEST(UnsteadinessTest, DoesNotPretendBeforeItHasSeenAnything) {
  EXPECT_GT(std::sqrt(Unsteadiness().covariance()(0, 0)), 0.01);
  EXPECT_GT(std::sqrt(Unsteadiness().covariance()(4, 4)), 1e-3);
}

}  // namespace
}  // namespace curbstone
