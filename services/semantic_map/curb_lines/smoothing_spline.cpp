#include "services/semantic_map/curb_lines/smoothing_spline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::semantic_map::curb_lines {

namespace {

constexpr double kKnots = 0.5;      // m between knots
constexpr double kStiffness = 2.0;  // of the penalty, against samples of weight 1
constexpr double kStraight = 1e-3;  // the same for second differences: between few points the line is straight
constexpr double kOutlier = 0.03;   // m off the line: half the weight
constexpr int kFits = 3;
constexpr int kBand = 3;  // a sample touches four coefficients, a third difference too

/// The four cubic B-splines that are not zero at u in [0, 1) of a span, and their derivatives by u.
std::array<double, 4> basis(double u) {
  const double v = 1 - u;
  return {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6};
}
std::array<double, 4> basis_slope(double u) {
  const double v = 1 - u;
  return {-v * v / 2, (3 * u * u - 4 * u) / 2, -(3 * v * v - 4 * v) / 2, u * u / 2};
}

/// Symmetric, positive definite, with kBand diagonals below the main one: [i][k] is A(i, i - k).
using BandedMatrix = std::vector<std::array<double, kBand + 1>>;

/// Cholesky's factor in place of the matrix, then both triangles solved in place of the right-hand sides.
void solve(BandedMatrix& a, std::vector<SmoothingSpline::Values>& b) {
  const std::size_t n = a.size();
  const auto first = [](std::size_t i) { return i > kBand ? i - kBand : 0; };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = first(i); j <= i; ++j) {
      double sum = a[i][i - j];
      for (std::size_t k = std::max(first(i), first(j)); k < j; ++k) sum -= a[i][i - k] * a[j][j - k];
      a[i][i - j] = i == j ? std::sqrt(sum) : sum / a[j][0];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = first(i); k < i; ++k) b[i] -= a[i][i - k] * b[k];
    b[i] /= a[i][0];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < std::min(n, i + kBand + 1); ++k) b[i] -= a[k][k - i] * b[k];
    b[i] /= a[i][0];
  }
}

template <std::size_t kTerms>
void penalise(const std::array<double, kTerms>& difference, double stiffness, BandedMatrix& a) {
  for (std::size_t j = 0; j + kTerms <= a.size(); ++j) {
    for (std::size_t r = 0; r < kTerms; ++r) {
      for (std::size_t c = 0; c <= r; ++c) a[j + r][r - c] += stiffness * difference[r] * difference[c];
    }
  }
}

struct Span {
  std::size_t first = 0;  // coefficient
  double u = 0;
};

Span span_at(double s, double begin, std::size_t coefficients) {
  const double t = std::max(0.0, (s - begin) / kKnots);
  const std::size_t first = std::min(static_cast<std::size_t>(t), coefficients - 4);
  return {first, t - static_cast<double>(first)};
}

}  // namespace

SmoothingSpline::SmoothingSpline(const std::vector<Sample>& samples)
    : begin_(samples.front().s), end_(samples.back().s), origin_(samples.front().values) {
  coefficients_.resize(static_cast<std::size_t>(std::max(1.0, std::ceil((end_ - begin_) / kKnots))) + 3);
  std::vector<double> weights;
  for (const Sample& sample : samples) weights.push_back(sample.weight);
  fit(samples, weights);
  for (int round = 1; round < kFits; ++round) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double off = (samples[i].values - at(samples[i].s)).head<2>().norm() / kOutlier;
      weights[i] = samples[i].weight / (1 + off * off);
    }
    fit(samples, weights);
  }
}

void SmoothingSpline::fit(const std::vector<Sample>& samples, const std::vector<double>& weights) {
  const std::size_t n = coefficients_.size();
  BandedMatrix a(n, {0, 0, 0, 0});
  std::vector<Values> b(n, Values::Zero());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Span span = span_at(samples[i].s, begin_, n);
    const auto weight_of = basis(span.u);
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c <= r; ++c) a[span.first + r][r - c] += weights[i] * weight_of[r] * weight_of[c];
      b[span.first + r] += weights[i] * weight_of[r] * (samples[i].values - origin_);
    }
  }
  penalise<4>({-1, 3, -3, 1}, kStiffness, a);
  penalise<3>({1, -2, 1}, kStraight, a);
  for (auto& row : a) row[0] += 1e-9;  // with a single point all coefficients are equal
  solve(a, b);
  coefficients_ = std::move(b);
}

SmoothingSpline::Values SmoothingSpline::at(double s) const {
  const Span span = span_at(s, begin_, coefficients_.size());
  const auto weight_of = basis(span.u);
  Values values = origin_;
  for (std::size_t k = 0; k < 4; ++k) values += weight_of[k] * coefficients_[span.first + k];
  return values;
}

SmoothingSpline::Values SmoothingSpline::derivative(double s) const {
  const Span span = span_at(s, begin_, coefficients_.size());
  const auto weight_of = basis_slope(span.u);
  Values values = Values::Zero();
  for (std::size_t k = 0; k < 4; ++k) values += weight_of[k] / kKnots * coefficients_[span.first + k];
  return values;
}

}  // namespace curbstone::semantic_map::curb_lines
