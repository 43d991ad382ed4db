#include "services/semantic_map/curbs/height_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace curbstone::semantic_map::curbs {
namespace {

constexpr double kNoise = 0.006;  // m

/// Points of ground about a step at u = 0, even over a window of 1.2 x 1 m.
class StepGround {
 public:
  template <class Height>
  StepGround& even(int count, Height height) {
    for (int i = 0; i < count; ++i) add(uniform(-0.6, 0.6), uniform(-0.5, 0.5), height);
    return *this;
  }
  /// A scan line along the step at u.
  template <class Height>
  StepGround& line(double u, Height height) {
    for (double t = -0.5; t < 0.5; t += 0.05) add(u + noise_(random_), t, height);
    return *this;
  }
  StepWindow points;

 private:
  template <class Height>
  void add(double u, double t, Height height) {
    points.add(u, t, height(u, t) + noise_(random_));
  }
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_{0, kNoise};
};

double flat_step(double u, double /*t*/) {
  return u > 0 ? 0.08 : 0.0;
}

TEST(HeightStep, IsFoundWithItsHeightAndItsUncertainty) {
  StepGround ground;
  const StepWindow points = ground.even(150, flat_step).points;
  const auto step = find_height_step(points, kNoise, {});
  ASSERT_TRUE(step);
  EXPECT_NEAR(step->height, 0.08, 3 * step->sigma);
  EXPECT_LT(step->sigma, 0.006);
  EXPECT_NEAR(step->roughness, kNoise, 0.003);
  EXPECT_NEAR(step->at, 0, 0.031);
  EXPECT_GT(evaluate_sides(points, *step, {}).clear, 0.06);
}

/// docs/method.md, section 11, for one place of the step: z_0, the slope and h by QR of the rows themselves, the priors
/// among them. Nothing if a side is thin.
std::optional<HeightStep> step_by_definition(const StepWindow& points, double at, double noise) {
  std::vector<Eigen::Vector4d> rows;  // of z_0, s_u, s_t, h
  std::vector<double> heights;
  Eigen::Vector3d mean[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double n[2] = {0, 0}, squares[2] = {0, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double from = std::floor(points.u[i] / 0.03) - std::round(at / 0.03);  // bins of 3 cm
    const int side = from >= 1 && from < 12 ? 1 : from >= -12 && from < -1 ? 0 : -1;
    if (side < 0 || points.unfit[i] > 0) continue;
    rows.emplace_back(1, points.u[i], points.t[i], side);
    heights.push_back(points.z[i]);
    mean[side] += Eigen::Vector3d(points.u[i], points.t[i], points.z[i]);
    squares[side] += points.u[i] * points.u[i];
    ++n[side];
  }
  for (int side = 0; side < 2; ++side) {
    mean[side] /= n[side];
    if (!(squares[side] / n[side] - mean[side].x() * mean[side].x() >= 0.05 * 0.05)) return std::nullopt;
  }
  const double all = n[0] + n[1];
  const double place = all * 0.04 * 0.04;
  rows.emplace_back(0, std::sqrt(place + noise * noise / (0.30 * 0.30)), 0, 0);
  rows.emplace_back(0, 0, std::sqrt(place + noise * noise / (0.05 * 0.05)), 0);
  heights.insert(heights.end(), {0.0, 0.0});
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), 4);
  for (std::size_t i = 0; i < rows.size(); ++i) A.row(static_cast<Eigen::Index>(i)) = rows[i];
  const Eigen::Map<const Eigen::VectorXd> z(heights.data(), A.rows());
  const Eigen::Vector4d found = A.colPivHouseholderQr().solve(z);
  const Eigen::Matrix4d inverse = (A.transpose() * A).inverse();
  // Of the unknowns' inverse the slopes' part is S^-1, and that of h is 1/n_low + 1/n_high + a^T S^-1 a.
  const Eigen::Vector2d apart = (mean[1] - mean[0]).head<2>();
  const double missing = 1.2 * place * (inverse.block<2, 2>(1, 1) * apart).x();
  HeightStep step;
  step.at = at;
  step.height = found(3);
  step.level = (mean[1] - mean[0]).z();
  step.full_height = step.height / (1 - std::clamp(missing, 0.0, 0.5));
  step.roughness = std::sqrt((A * found - z).squaredNorm() / (all - 4) + 0.004 * 0.004);
  step.sigma = step.roughness * std::sqrt(inverse(3, 3));
  step.low_z = found(0) + found(1) * at;
  step.slope = found.segment<2>(1);
  return step;
}

TEST(HeightStep, IsTheMostCertainOfTheTwoHalfPlanesOfTheMethod) {
  const auto leaning = [](double u, double t) { return (u > 0.07 ? 0.08 : 0.0) - 0.1 * u + 0.04 * t; };
  for (const double noise : {0.002, kNoise, 0.03}) {  // below 4 mm it counts as 4 mm
    StepGround ground;
    const StepWindow points = ground.even(200, leaning).points;
    const auto step = find_height_step(points, noise, {});
    ASSERT_TRUE(step);
    const auto expected = step_by_definition(points, step->at, std::max(noise, 0.004));
    ASSERT_TRUE(expected);
    EXPECT_NEAR(step->height, expected->height, 1e-9);
    EXPECT_NEAR(step->level, expected->level, 1e-9);
    EXPECT_NEAR(step->full_height, expected->full_height, 1e-9);
    EXPECT_NEAR(step->roughness, expected->roughness, 1e-9);
    EXPECT_NEAR(step->sigma, expected->sigma, 1e-9);
    EXPECT_NEAR(step->low_z, expected->low_z, 1e-9);
    EXPECT_LT((step->slope - expected->slope).norm(), 1e-9);
    for (int k = -6; k <= 6; ++k) {
      const auto other = step_by_definition(points, 0.03 * k, std::max(noise, 0.004));
      if (other) {
        EXPECT_LE(other->height / other->sigma, step->height / step->sigma + 1e-9) << k;
      }
    }
  }
}

TEST(HeightStep, IsNotSeenInASlope) {
  StepGround ground;
  const auto step =
      find_height_step(ground.even(150, [](double u, double t) { return 0.1 * u + 0.05 * t; }).points, kNoise, {});
  ASSERT_TRUE(step);
  EXPECT_LT(step->height, 4 * step->sigma);
}

TEST(HeightStep, BetweenScanLinesAlongItIsNoneForNothingSaysThatALineIsNotOff) {
  StepGround ground;
  ground.line(-0.30, flat_step).line(-0.12, flat_step).line(0.12, flat_step).line(0.30, flat_step);
  EXPECT_FALSE(find_height_step(ground.points, kNoise, {}));
}

TEST(HeightStep, OfALayerThatEndsDoesNotPartTheTwoSides) {
  StepGround ground;  // all over lies one layer, on the far side a second one 5 cm higher
  ground.even(300, [](double, double) { return 0.0; });
  for (double u = 0.02; u < 0.4; u += 0.08) ground.line(u, [](double, double) { return 0.05; });
  const auto layers = find_height_step(ground.points, kNoise, {});
  ASSERT_TRUE(layers);
  EXPECT_LT(evaluate_sides(ground.points, *layers, {}).clear, 0.4 * layers->height);
}

/// Two scan lines on even ground that run aslant through the window. Range noise moves their points along beams that
/// fall: as if the ground fell so within each line, and stepped up to the next.
struct AslantLines {
  double beam_slope, apart, aslant, half_length, range_noise;

  [[nodiscard]] StepWindow seen(unsigned seed) const {
    std::mt19937 random{seed};
    std::normal_distribution<double> along_beam{0, range_noise};
    std::normal_distribution<double> other_noise{0, 0.003};
    StepWindow points;
    points.half_length = half_length;
    for (double t = -half_length; t < half_length; t += 0.04 * half_length) {
      for (const double side : {-0.5, 0.5}) {
        const double away = along_beam(random);
        points.add(side * apart + aslant * t + away, t, -beam_slope * away + other_noise(random));
      }
    }
    return points;
  }
};

TEST(HeightStep, IsNotMadeOfTheRangeNoiseWithinScanLines) {
  constexpr AslantLines kLines{
      .beam_slope = 0.2, .apart = 0.3, .aslant = 0.24, .half_length = 0.5, .range_noise = 0.02};
  const auto step = find_height_step(kLines.seen(1), kNoise, {});
  ASSERT_TRUE(step);
  EXPECT_LT(step->height, 0.01);
}

/// Farther out, where it takes a long window to see two sides at all.
TEST(HeightStep, SaysThatItIsOnlyThereBecauseItsSidesFall) {
  constexpr AslantLines kLines{
      .beam_slope = 0.14, .apart = 0.4, .aslant = 0.18, .half_length = 1.0, .range_noise = 0.04};
  int high = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto step = find_height_step(kLines.seen(seed), kNoise, {});
    if (!step || step->height < 0.015) continue;
    ++high;
    EXPECT_TRUE(step->falls());
  }
  EXPECT_GT(high, 5);
}

/// The refined ground climbs a step within about a metre: against it both sides fall.
TEST(HeightStep, OfACurbDoesNotOnlyFallThoughTheGroundLeansAgainstIt) {
  for (const double height : {0.05, 0.10, 0.15}) {
    StepGround ground;
    const auto leaning = [&](double u, double /*t*/) { return (u > 0 ? height : 0.0) - 1.2 * height * u; };
    const auto step = find_height_step(ground.even(300, leaning).points, kNoise, {});
    ASSERT_TRUE(step);
    EXPECT_NEAR(step->full_height, height, 0.1 * height);
    EXPECT_FALSE(step->falls());
  }
}

TEST(HeightStep, IsReportedNeitherLowerThanItIsCertainToBeNorAboveTwiceThat) {
  std::mt19937 random{1};
  std::uniform_real_distribution<double> place{-0.5, 0.5};
  std::normal_distribution<double> noise{0, 0.005};
  int found = 0;
  for (int round = 0; round < 300; ++round) {
    StepWindow points;
    points.half_length = 1.0;
    const double low_at = 2 * place(random);  // each side is a strip somewhere along the step
    const double high_at = 2 * place(random);
    for (int i = 0; i < 60; ++i) {
      const double u = place(random);
      points.add(u, (u < 0 ? low_at : high_at) + 0.1 * place(random), (u < 0 ? 0.0 : 0.1) + noise(random));
    }
    const auto step = find_height_step(points, kNoise, {});
    if (!step || step->height <= 0) continue;
    ++found;
    EXPECT_GE(step->full_height, step->height);
    EXPECT_LE(step->full_height, 2 * step->height + 1e-9);
  }
  EXPECT_GT(found, 100);
}

/// One scan line crosses the step obliquely: the sides are seen at different places along it, on ground of no slope.
TEST(HeightStep, KnowsThatAnObliqueScanLineMayHaveClimbedASlopeAlongTheCurb) {
  StepGround ground;
  for (double u = -0.5; u < 0.5; u += 0.02) ground.points.add(u, u, flat_step(u, 0));
  StepGround across;
  for (double u = -0.5; u < 0.5; u += 0.02) across.points.add(u, 0, flat_step(u, 0));
  const auto oblique = find_height_step(ground.points, kNoise, {});
  const auto straight = find_height_step(across.points, kNoise, {});
  ASSERT_TRUE(oblique && straight);
  EXPECT_NEAR(straight->height, 0.08, 0.01);
  EXPECT_GE(oblique->sigma, straight->sigma);
}

}  // namespace
}  // namespace curbstone::semantic_map::curbs
