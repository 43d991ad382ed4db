#include "services/semantic_map/curb_lines/smoothing_spline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>

namespace curbstone::semantic_map::curb_lines {
namespace {

using Values = SmoothingSpline::Values;
using Samples = std::vector<SmoothingSpline::Sample>;
using Course = std::function<Values(double s)>;

constexpr double kSpacing = 0.12;  // m: a curb point a cell

Values line(double s) {
  return Values(100, -50, 2, 0.12) + s * Values(0.6, 0.8, 0.02, 0.003);
}
Values circle(double s) {
  constexpr double kRadius = 8;
  return {kRadius * std::sin(s / kRadius), kRadius - kRadius * std::cos(s / kRadius), 0, 0.12};
}
Values cubic(double s) {
  return {s, 0.002 * s * s * s - 0.03 * s * s, 0.1 * s, 0.12};
}

Samples sampled(const Course& curve, double from, double to, double sigma = 0) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  Samples samples;
  for (double s = from; s < to + 1e-9; s += kSpacing) {
    samples.push_back({s, curve(s)});
    for (double& value : samples.back().values) value += sigma * noise(random);
  }
  return samples;
}
/// Root mean square of x and y off the curve.
double rms_off(const SmoothingSpline& spline, const Course& curve) {
  double sum = 0;
  int count = 0;
  for (double s = spline.begin(); s < spline.end(); s += 0.05, ++count)
    sum += (spline.at(s) - curve(s)).head<2>().squaredNorm();
  return std::sqrt(sum / count);
}

/// B-spline of a degree on whole knots from `knot` on, by the recursion of Cox and de Boor.
double b_spline(double t, int knot, int degree) {
  if (degree == 0) return t >= knot && t < knot + 1 ? 1 : 0;
  return ((t - knot) * b_spline(t, knot, degree - 1) + (knot + degree + 1 - t) * b_spline(t, knot + 1, degree - 1)) /
         degree;
}

/// docs/method.md, section 12: the values at `places` of the spline that minimises what is said there, with weights by
/// the fit before.
std::vector<Values> spline_by_definition(const Samples& samples, const std::vector<double>& places) {
  constexpr double kKnots = 0.5;
  const double begin = samples.front().s;
  const auto n = static_cast<Eigen::Index>(std::ceil((samples.back().s - begin) / kKnots)) + 3;
  const auto basis_at = [&](double s) {
    Eigen::RowVectorXd row(n);
    for (Eigen::Index k = 0; k < n; ++k) row(k) = b_spline((s - begin) / kKnots, static_cast<int>(k) - 3, 3);
    return row;
  };
  Eigen::MatrixXd third = Eigen::MatrixXd::Zero(n - 3, n), second = Eigen::MatrixXd::Zero(n - 2, n);
  for (Eigen::Index k = 0; k < n - 3; ++k) third.row(k).segment<4>(k) << -1, 3, -3, 1;
  for (Eigen::Index k = 0; k < n - 2; ++k) second.row(k).segment<3>(k) << 1, -2, 1;
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(n, 4);
  for (int round = 0; round < 3; ++round) {
    Eigen::MatrixXd normal = 2 * third.transpose() * third + 0.001 * second.transpose() * second;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 4);
    for (const SmoothingSpline::Sample& sample : samples) {
      const Eigen::RowVectorXd row = basis_at(sample.s);
      const double off = (sample.values.transpose() - row * found).head<2>().norm() / 0.03;
      const double weight = sample.weight / (round == 0 ? 1 : 1 + off * off);
      normal += weight * row.transpose() * row;
      right += weight * row.transpose() * sample.values.transpose();
    }
    found = normal.ldlt().solve(right);
  }
  std::vector<Values> values;
  for (const double s : places) values.emplace_back((basis_at(s) * found).transpose());
  return values;
}

TEST(SmoothingSpline, MinimisesWhatTheMethodSays) {
  Samples samples = sampled(cubic, 1, 7.3, 0.02);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].weight = 0.2 + 0.1 * static_cast<double>(i % 5);
  samples[10].values.y() += 0.2;
  const std::vector<double> places = {1, 1.7, 2.25, 4, 6.9};
  const std::vector<Values> expected = spline_by_definition(samples, places);
  const SmoothingSpline spline(samples);
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_LT((spline.at(places[i]) - expected[i]).cwiseAbs().maxCoeff(), 1e-6) << places[i];
}

TEST(SmoothingSpline, ReachesFromTheFirstSampleToTheLast) {
  const SmoothingSpline spline(sampled(line, 3, 9));
  EXPECT_DOUBLE_EQ(spline.begin(), 3);
  EXPECT_DOUBLE_EQ(spline.end(), 9);
}

TEST(SmoothingSpline, LeavesAStraightLineAsItIsInAllItsValues) {
  for (const double length : {0.24, 2.0, 30.0}) {
    const SmoothingSpline spline(sampled(line, 0, length));
    for (double s = 0; s <= spline.end(); s += 0.07) {
      EXPECT_LT((spline.at(s) - line(s)).cwiseAbs().maxCoeff(), 1e-6) << s << " of " << length;
      EXPECT_LT((spline.derivative(s) - Values(0.6, 0.8, 0.02, 0.003)).cwiseAbs().maxCoeff(), 1e-6) << s;
    }
  }
}

TEST(SmoothingSpline, LeavesAnEvenBendAsItIs) {
  const SmoothingSpline spline(sampled(circle, 0, 12));
  for (double s = 0; s <= spline.end(); s += 0.07)
    EXPECT_LT((spline.at(s) - circle(s)).head<2>().norm(), 0.0015) << "at " << s << " of a circle of 8 m";
}

TEST(SmoothingSpline, FollowsACubicToMillimetres) {
  const SmoothingSpline spline(sampled(cubic, 0, 10));
  for (double s = 0; s <= spline.end(); s += 0.07) {
    EXPECT_LT((spline.at(s) - cubic(s)).norm(), 0.003) << s;
    EXPECT_NEAR(spline.derivative(s).y(), 0.006 * s * s - 0.06 * s, 0.02) << s;
  }
}

TEST(SmoothingSpline, TheDerivativeIsThatOfTheValues) {
  const SmoothingSpline spline(sampled(cubic, 0, 10, 0.02));
  constexpr double kDelta = 1e-5;
  for (double s = 0.03; s < 9.9; s += 0.11) {  // at knots too: the second derivative is continuous
    const Values expected = (spline.at(s + kDelta) - spline.at(s - kDelta)) / (2 * kDelta);
    EXPECT_LT((spline.derivative(s) - expected).norm(), 1e-6) << s;
  }
}

TEST(SmoothingSpline, ManyPointsAreMorePreciseThanOne) {
  constexpr double kSigma = 0.01;  // of x and y: a single point is off by 1.4 cm
  for (const Course& curve : {Course(line), Course(circle)})
    EXPECT_LT(rms_off(SmoothingSpline(sampled(curve, 0, 20, kSigma)), curve), 0.5 * std::sqrt(2) * kSigma);
}

TEST(SmoothingSpline, AnOutlierHardlyBendsIt) {
  Samples samples = sampled(line, 0, 10);
  const std::size_t middle = samples.size() / 2;
  samples[middle].values.head<2>() += 0.3 * Eigen::Vector2d(-0.8, 0.6);
  const SmoothingSpline spline(samples);
  EXPECT_LT((spline.at(samples[middle].s) - line(samples[middle].s)).norm(), 0.005) << "of 0.3 m";
}

TEST(SmoothingSpline, AGapIsCrossedStraight) {
  Samples samples = sampled(line, 0, 2);
  for (const auto& sample : sampled(line, 6, 8)) samples.push_back(sample);
  const SmoothingSpline spline(samples);
  for (double s = 2; s < 6; s += 0.1) EXPECT_LT((spline.at(s) - line(s)).norm(), 1e-5) << s;
}

TEST(SmoothingSpline, InOnePlaceItIsTheWeightedMean) {
  const Values low(1, 2, 3, 0.1), high = low + Values(0, 1e-3, 0, 0);
  const SmoothingSpline spline({{5, low, 1}, {5, high, 3}});
  EXPECT_NEAR(spline.at(5).y(), 2 + 0.75e-3, 2e-6);
}

TEST(SmoothingSpline, OfASinglePointItIsThatPoint) {
  const SmoothingSpline spline({{5, Values(1, 2, 3, 0.1)}});
  EXPECT_LT((spline.at(5) - Values(1, 2, 3, 0.1)).norm(), 1e-9);
  EXPECT_LT(spline.derivative(5).norm(), 1e-9);
}

}  // namespace
}  // namespace curbstone::semantic_map::curb_lines
