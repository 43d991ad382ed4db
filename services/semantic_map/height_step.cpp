#include "services/semantic_map/height_step.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone {

namespace {

constexpr double kBin = 0.03;          // m in u: the step is sought at this grain
constexpr int kRiserBins = 1;          // on each side of the step: left out of the fit, the riser's own points
constexpr double kMaxShift = 0.18;     // m: how far from u = 0 the step may be
constexpr int kMinPoints = 6;          // a side
constexpr double kMinSpread = 0.05;    // m, standard deviation of u on a side: a thin line of points is no side
constexpr double kNoiseFloor = 0.004;  // m
constexpr double kSlopeAcross = 0.30;  // 1 sigma of the slope that both sides share, against the ground's
constexpr double kSlopeAlong = 0.05;

/// Sums over some points, from which means and scatter follow.
struct Moments {
  double n = 0, u = 0, t = 0, z = 0, uu = 0, ut = 0, tt = 0, uz = 0, tz = 0, zz = 0;

  void add(const StepPointUTZ& p) {
    n += 1;
    u += p.u;
    t += p.t;
    z += p.z;
    uu += p.u * p.u;
    ut += p.u * p.t;
    tt += p.t * p.t;
    uz += p.u * p.z;
    tz += p.t * p.z;
    zz += p.z * p.z;
  }
  Moments& operator+=(const Moments& o) {
    n += o.n;
    u += o.u;
    t += o.t;
    z += o.z;
    uu += o.uu;
    ut += o.ut;
    tt += o.tt;
    uz += o.uz;
    tz += o.tz;
    zz += o.zz;
    return *this;
  }
};

/// Scatter about the mean, of one side or summed over both.
struct Scatter {
  Eigen::Matrix2d xx = Eigen::Matrix2d::Zero();
  Eigen::Vector2d xz = Eigen::Vector2d::Zero();
  double zz = 0;

  void add(const Moments& m) {
    const double u = m.u / m.n;
    const double t = m.t / m.n;
    const double z = m.z / m.n;
    const double ut = m.ut - m.n * u * t;
    xx += Eigen::Matrix2d{{m.uu - m.n * u * u, ut}, {ut, m.tt - m.n * t * t}};
    xz += Eigen::Vector2d(m.uz - m.n * u * z, m.tz - m.n * t * z);
    zz += m.zz - m.n * z * z;
  }
};

bool is_side(const Moments& m) {
  return m.n >= kMinPoints && m.uu / m.n - (m.u / m.n) * (m.u / m.n) >= kMinSpread * kMinSpread;
}

/// A side is ground seen all over, not a scan line or two that run along the step: all points of a line may be off by
/// the same, and nothing else there would say so.
bool is_covered(const std::vector<Moments>& bins, int from, int to, double min_cover) {
  int covered = 0;
  for (int b = from; b < to; ++b) covered += bins[static_cast<std::size_t>(b)].n > 0 ? 1 : 0;
  return covered >= min_cover * (to - from);
}

/// A side is ground that goes on, not the face of something.
bool reaches_out(const std::vector<Moments>& bins, int from, int to) {
  constexpr double kMinFarPoints = 3;
  double n = 0;
  for (int b = from; b < to; ++b) n += bins[static_cast<std::size_t>(b)].n;
  return n >= kMinFarPoints;
}

struct Fit {
  HeightStep step;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

Fit fit_sides(const Moments& low, const Moments& high, double at, double noise) {
  Scatter scatter;
  scatter.add(low);
  scatter.add(high);
  // What the slope against the ground's may be is known beforehand: little along the curb, where thin scan lines that
  // meet the two sides at different places would otherwise trade it for a step; more across, where the ground's own
  // model leans at a curb.
  const Eigen::Vector2d prior(noise / kSlopeAcross, noise / kSlopeAlong);
  const Eigen::Matrix2d inverse =
      (scatter.xx + Eigen::Matrix2d(prior.array().square().matrix().asDiagonal())).inverse();
  const Eigen::Vector2d slope = inverse * scatter.xz;
  const Eigen::Vector2d low_mean(low.u / low.n, low.t / low.n);
  const Eigen::Vector2d high_mean(high.u / high.n, high.t / high.n);
  const Eigen::Vector2d apart = high_mean - low_mean;
  const double rss = std::max(0.0, scatter.zz - slope.dot(scatter.xz));

  Fit fit;
  fit.slope = slope;
  fit.step.at = at;
  fit.step.height = high.z / high.n - low.z / low.n - slope.dot(apart);
  fit.step.roughness = std::sqrt(rss / (low.n + high.n - 4) + kNoiseFloor * kNoiseFloor);
  fit.step.sigma = fit.step.roughness * std::sqrt(1 / low.n + 1 / high.n + apart.dot(inverse * apart));
  fit.step.low_z = low.z / low.n + slope.x() * (at - low_mean.x()) - slope.y() * low_mean.y();
  return fit;
}

double fifth(std::vector<double>& values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// A real step parts the heights of its two sides. Where scan lines lie in layers, one of which ends, both layers are
/// found on one side.
double clear_height(const std::vector<StepPointUTZ>& points, const Fit& fit, double half_window) {
  std::vector<double> low;
  std::vector<double> high;
  for (const StepPointUTZ& p : points) {
    const double u = p.u - fit.step.at;
    if (!p.is_ground || std::abs(u) > half_window || std::abs(u) < kRiserBins * kBin) continue;
    (u < 0 ? low : high).push_back(p.z - fit.slope.x() * u - fit.slope.y() * p.t);
  }
  if (low.empty() || high.empty()) return 0;
  return fifth(high, 0.2) - fifth(low, 0.8);
}

/// Where the low side ends: the riser's points stand on the foot, so the foot is where points begin to rise.
double find_foot(const std::vector<StepPointUTZ>& points, const Fit& fit) {
  constexpr double kNear = 0.15;  // m on each side of the step
  const HeightStep& step = fit.step;
  std::vector<double> risen;
  for (const StepPointUTZ& p : points) {
    if (std::abs(p.u - step.at) > kNear) continue;
    const double above = p.z - step.low_z - fit.slope.x() * (p.u - step.at) - fit.slope.y() * p.t;
    if (above > 0.25 * step.height && above < 0.75 * step.height) risen.push_back(p.u);
  }
  if (risen.size() < 3) return step.at;
  const auto middle = risen.begin() + static_cast<std::ptrdiff_t>(risen.size() / 2);
  std::nth_element(risen.begin(), middle, risen.end());
  return std::clamp(*middle, step.at - kBin, step.at + kBin);
}

int count_face_above(const std::vector<StepPointUTZ>& points, const HeightStep& step) {
  constexpr double kNear = 0.12;   // m on each side of the step
  constexpr double kAbove = 0.10;  // m above its upper edge
  int count = 0;
  for (const StepPointUTZ& p : points) {
    if (std::abs(p.u - step.at) < kNear && p.z > step.low_z + step.height + kAbove) ++count;
  }
  return count;
}

}  // namespace

std::optional<HeightStep> find_height_step(const std::vector<StepPointUTZ>& points, double noise,
                                           const CurbParameters& parameters) {
  const int half = static_cast<int>(std::lround((parameters.half_window + kMaxShift) / kBin));
  std::vector<Moments> bins(static_cast<std::size_t>(2 * half));
  for (const StepPointUTZ& p : points) {
    const int bin = static_cast<int>(std::floor(p.u / kBin)) + half;
    if (p.is_ground && bin >= 0 && bin < 2 * half) bins[static_cast<std::size_t>(bin)].add(p);
  }
  const int shift = static_cast<int>(std::lround(kMaxShift / kBin));
  const int window = static_cast<int>(std::lround(parameters.half_window / kBin));
  const int far = window / 2;
  std::optional<Fit> best;
  for (int k = half - shift; k <= half + shift; ++k) {  // the step is between bins k - 1 and k
    Moments low;
    Moments high;
    for (int b = k - window; b < k - kRiserBins; ++b) low += bins[static_cast<std::size_t>(b)];
    for (int b = k + kRiserBins; b < k + window; ++b) high += bins[static_cast<std::size_t>(b)];
    if (!is_side(low) || !is_side(high)) continue;
    if (!reaches_out(bins, k - window, k - far) || !reaches_out(bins, k + far, k + window)) continue;
    if (!is_covered(bins, k - window, k - kRiserBins, parameters.min_cover) ||
        !is_covered(bins, k + kRiserBins, k + window, parameters.min_cover))
      continue;
    const Fit fit = fit_sides(low, high, (k - half) * kBin, std::max(noise, kNoiseFloor));
    if (!best || fit.step.height * best->step.sigma > best->step.height * fit.step.sigma) best = fit;
  }
  if (!best) return std::nullopt;
  best->step.foot = find_foot(points, *best);
  best->step.clear = clear_height(points, *best, parameters.half_window);
  best->step.face_above = count_face_above(points, best->step);
  return best->step;
}

}  // namespace curbstone
