#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace curbstone::simulate::numerics {

/// Weights of the four control points around a place of a uniform cubic B-spline; `f`: 0..1 within the span. Twice
/// continuously differentiable, as an IMU requires of a path.
[[nodiscard]] inline std::array<double, 4> cubic_b_spline_weights(double f) {
  const double g = 1.0 - f;
  return {g * g * g / 6.0, (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0,
          (-3.0 * f * f * f + 3.0 * f * f + 3.0 * f + 1.0) / 6.0, f * f * f / 6.0};
}

/// A uniform cubic B-spline through a vector space: at integer u it is near control point u (it smooths, it does not
/// interpolate). Closed: u wraps at the number of points. Open: it continues straight beyond its ends.
template <class Value>
class Spline {
 public:
  Spline() = default;
  Spline(std::vector<Value> points, bool closed) : points_(std::move(points)), closed_(closed) {}

  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  /// The u at which it repeats (closed), or ends.
  [[nodiscard]] double length() const { return static_cast<double>(closed_ ? points_.size() : points_.size() - 1); }

  [[nodiscard]] Value at(double u) const {
    const double base = std::floor(u);
    const auto w = cubic_b_spline_weights(u - base);
    const auto i = static_cast<long>(base);
    Value sum = point(i - 1) * w[0] + point(i) * w[1];
    sum = sum + point(i + 1) * w[2];
    return sum + point(i + 2) * w[3];
  }

  [[nodiscard]] Value derivative(double u, double step = 1e-4) const {
    return (at(u + step) - at(u - step)) * (0.5 / step);
  }

 private:
  [[nodiscard]] Value point(long i) const {
    const auto n = static_cast<long>(points_.size());
    const auto stored = [this](long k) -> const Value& { return points_[static_cast<std::size_t>(k)]; };
    if (i >= 0 && i < n) return stored(i);  // without a division
    if (closed_) return stored(((i % n) + n) % n);
    if (i < 0) return stored(0) + (stored(0) - stored(1)) * static_cast<double>(-i);
    return stored(n - 1) + (stored(n - 1) - stored(n - 2)) * static_cast<double>(i - n + 1);
  }

  std::vector<Value> points_;
  bool closed_ = false;
};

}  // namespace curbstone::simulate::numerics
