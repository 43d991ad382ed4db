#include "tools/simulate/world/street.hpp"

#include <cmath>

namespace curbstone::simulate::world {

namespace {

double smooth_blend(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

constexpr double kRamp = 0.7;   // m along the street from full height to lowered
constexpr double kBlend = 2.0;  // m along the street over which the heights of two stretches are blended

}  // namespace

double CurbSide::full_height(double s, double street_length, bool closed) const {
  if (heights.empty()) return 0.12;
  const auto n = static_cast<long>(heights.size());
  if (closed) s -= street_length * std::floor(s / street_length);
  const double u = s / stretch;
  const long i = std::clamp(static_cast<long>(std::floor(u)), 0L, n - 1);
  const long next = closed ? (i + 1) % n : std::min(i + 1, n - 1);
  const double end = i == n - 1 && closed ? street_length : static_cast<double>(i + 1) * stretch;
  const double f = smooth_blend((s - (end - kBlend)) / kBlend);
  return heights[static_cast<std::size_t>(i)] * (1.0 - f) + heights[static_cast<std::size_t>(next)] * f;
}

double CurbSide::height(double s, double street_length, bool closed) const {
  double height = full_height(s, street_length, closed);
  for (const auto& kerb : dropped) {
    double off = std::abs(s - kerb.s);
    if (closed) off = std::min(off, street_length - off);
    if (off > kerb.half + kRamp) continue;
    const double f = smooth_blend((off - kerb.half) / kRamp);
    height = std::min(height, kerb.height * (1.0 - f) + height * f);
  }
  return height;
}

Street::Street(const numerics::Spline<Eigen::Vector2d>& line, double half_width)
    : half_width_(half_width), closed_(line.closed()) {
  constexpr double kStep = 0.5;  // m
  const auto points = static_cast<int>(line.length() * 40);
  Eigen::Vector2d last = line.at(0.0);
  double since = kStep;
  for (int i = 0; i <= points; ++i) {
    const double u = line.length() * i / points;
    const Eigen::Vector2d p = line.at(u);
    length_ += (p - last).norm();
    since += (p - last).norm();
    last = p;
    if (since < kStep || (closed_ && i == points)) continue;
    since = 0;
    samples_.push_back({p, line.derivative(u, 1e-3).normalized(), length_});
  }
}

Street::Sample Street::at(double s) const {
  const auto n = samples_.size();
  if (closed_) s -= length_ * std::floor(s / length_);
  std::size_t low = 0, high = n;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (samples_[middle].s <= s ? low : high) = middle;
  }
  const Sample& a = samples_[low];
  if (low + 1 == n && !closed_) return a;
  const Sample& b = samples_[(low + 1) % n];
  const double end = low + 1 == n ? length_ : b.s;
  const double f = std::clamp((s - a.s) / std::max(1e-9, end - a.s), 0.0, 1.0);
  return {a.point + f * (b.point - a.point), (a.tangent + f * (b.tangent - a.tangent)).normalized(), s};
}

}  // namespace curbstone::simulate::world
