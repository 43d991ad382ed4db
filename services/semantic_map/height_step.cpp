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
constexpr int kMinFarPoints = 3;       // in a side's outer half: ground that goes on, not the face of something
constexpr double kMinSpread = 0.05;    // m, standard deviation of u on a side: a thin line of points is no side
constexpr double kNoiseFloor = 0.004;  // m
constexpr double kSlopeAcross = 0.30;  // 1 sigma of the slope that both sides share, against the ground's
constexpr double kSlopeAlong = 0.05;

/// Two sums that are kept in step: one instruction adds to both.
using Pair = Eigen::Array2d;

/// Sums over some points, from which means and scatter follow.
struct Moments {
  double n = 0, u = 0;
  Pair t_z = Pair::Zero(), uu_ut = Pair::Zero(), tt_uz = Pair::Zero(), tz_zz = Pair::Zero();

  /// All but n.
  void add(double at_u, double t, double z) {
    const Pair tz(t, z);
    u += at_u;
    t_z += tz;
    uu_ut += Pair(at_u, at_u) * Pair(at_u, t);
    tt_uz += Pair(t, at_u) * tz;
    tz_zz += Pair(z, z) * tz;
  }
  Moments& operator+=(const Moments& o) {
    n += o.n;
    u += o.u;
    t_z += o.t_z;
    uu_ut += o.uu_ut;
    tt_uz += o.tt_uz;
    tz_zz += o.tz_zz;
    return *this;
  }
  [[nodiscard]] double t() const { return t_z(0); }
  [[nodiscard]] double z() const { return t_z(1); }
  [[nodiscard]] double uu() const { return uu_ut(0); }
  [[nodiscard]] double ut() const { return uu_ut(1); }
  [[nodiscard]] double tt() const { return tt_uz(0); }
  [[nodiscard]] double uz() const { return tt_uz(1); }
  [[nodiscard]] double tz() const { return tz_zz(0); }
  [[nodiscard]] double zz() const { return tz_zz(1); }
};

/// Scatter about the mean, of one side or summed over both.
struct Scatter {
  Eigen::Matrix2d xx = Eigen::Matrix2d::Zero();
  Eigen::Vector2d xz = Eigen::Vector2d::Zero();
  double zz = 0;

  void add(const Moments& m) {
    const double u = m.u / m.n;
    const double t = m.t() / m.n;
    const double z = m.z() / m.n;
    const double ut = m.ut() - m.n * u * t;
    xx += Eigen::Matrix2d{{m.uu() - m.n * u * u, ut}, {ut, m.tt() - m.n * t * t}};
    xz += Eigen::Vector2d(m.uz() - m.n * u * z, m.tz() - m.n * t * z);
    zz += m.zz() - m.n * z * z;
  }
};

bool is_spread(const Moments& m) {
  return m.uu() / m.n - (m.u / m.n) * (m.u / m.n) >= kMinSpread * kMinSpread;
}

/// The window cut into strips along the step: `half` of them on each side of u = 0.
struct Strips {
  int half = 0;
  std::vector<int> of_point;  ///< strip of each point that may carry a side, else -1
  std::vector<int> count;     ///< points in each

  void sort(const StepWindow& points, int num_half) {
    half = num_half;
    of_point.resize(points.size());
    count.assign(static_cast<std::size_t>(2 * half), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double q = points.u[i] / kBin;
      const int towards_zero = static_cast<int>(q);
      of_point[i] = towards_zero - (towards_zero > q ? 1 : 0) + half;  // rounded down
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      int& strip = of_point[i];
      if (points.is_ground[i] == 0 || strip < 0 || strip >= 2 * half)
        strip = -1;
      else
        ++count[static_cast<std::size_t>(strip)];
    }
  }
  [[nodiscard]] int points_in(int from, int to) const {
    int n = 0;
    for (int b = from; b < to; ++b) n += count[static_cast<std::size_t>(b)];
    return n;
  }
  [[nodiscard]] int covered(int from, int to) const {
    int n = 0;
    for (int b = from; b < to; ++b) n += count[static_cast<std::size_t>(b)] > 0 ? 1 : 0;
    return n;
  }
};

/// A side is ground seen all over, not a scan line or two that run along the step: all points of a line may be off by
/// the same, and nothing else there would say so. `far` is where its outer half begins or ends.
bool is_side(const Strips& strips, int from, int to, int far_from, int far_to, double min_cover) {
  return strips.points_in(from, to) >= kMinPoints && strips.points_in(far_from, far_to) >= kMinFarPoints &&
         strips.covered(from, to) >= min_cover * (to - from);
}

HeightStep fit_sides(const Moments& low, const Moments& high, double at, double noise) {
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
  const Eigen::Vector2d low_mean(low.u / low.n, low.t() / low.n);
  const Eigen::Vector2d high_mean(high.u / high.n, high.t() / high.n);
  const Eigen::Vector2d apart = high_mean - low_mean;
  const double rss = std::max(0.0, scatter.zz - slope.dot(scatter.xz));

  HeightStep step;
  step.slope = slope;
  step.at = at;
  step.height = high.z() / high.n - low.z() / low.n - slope.dot(apart);
  step.roughness = std::sqrt(rss / (low.n + high.n - 4) + kNoiseFloor * kNoiseFloor);
  step.sigma = step.roughness * std::sqrt(1 / low.n + 1 / high.n + apart.dot(inverse * apart));
  step.low_z = low.z() / low.n + slope.x() * (at - low_mean.x()) - slope.y() * low_mean.y();
  return step;
}

double fifth(std::vector<double>& values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// A real step parts the heights of its two sides. Where scan lines lie in layers, one of which ends, both layers are
/// found on one side.
double clear_height(const StepWindow& points, const HeightStep& step, double half_window) {
  std::vector<double> low;
  std::vector<double> high;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = points.u[i] - step.at;
    if (points.is_ground[i] == 0 || std::abs(u) > half_window || std::abs(u) < kRiserBins * kBin) continue;
    (u < 0 ? low : high).push_back(points.z[i] - step.slope.x() * u - step.slope.y() * points.t[i]);
  }
  if (low.empty() || high.empty()) return 0;
  return fifth(high, 0.2) - fifth(low, 0.8);
}

/// Where the low side ends: the riser's points stand on the foot, so the foot is where points begin to rise.
double find_foot(const StepWindow& points, const HeightStep& step) {
  constexpr double kNear = 0.15;  // m on each side of the step
  std::vector<double> risen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = points.u[i] - step.at;
    if (std::abs(u) > kNear) continue;
    const double above = points.z[i] - step.low_z - step.slope.x() * u - step.slope.y() * points.t[i];
    if (above > 0.25 * step.height && above < 0.75 * step.height) risen.push_back(points.u[i]);
  }
  if (risen.size() < 3) return step.at;
  const auto middle = risen.begin() + static_cast<std::ptrdiff_t>(risen.size() / 2);
  std::nth_element(risen.begin(), middle, risen.end());
  return std::clamp(*middle, step.at - kBin, step.at + kBin);
}

int count_face_above(const StepWindow& points, const HeightStep& step) {
  constexpr double kNear = 0.12;   // m on each side of the step
  constexpr double kAbove = 0.10;  // m above its upper edge
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points.u[i] - step.at) < kNear && points.z[i] > step.low_z + step.height + kAbove) ++count;
  }
  return count;
}

}  // namespace

void StepWindow::resize(std::size_t n) {
  u.resize(n);
  t.resize(n);
  z.resize(n);
  is_ground.resize(n);
}

void StepWindow::add(double at_u, double at_t, double at_z, bool ground) {
  u.push_back(at_u);
  t.push_back(at_t);
  z.push_back(at_z);
  is_ground.push_back(ground ? 1 : 0);
}

std::optional<HeightStep> find_height_step(const StepWindow& points, double noise, const CurbParameters& parameters) {
  const int half = static_cast<int>(std::lround((parameters.half_window + kMaxShift) / kBin));
  const int shift = static_cast<int>(std::lround(kMaxShift / kBin));
  const int window = static_cast<int>(std::lround(parameters.half_window / kBin));
  const int far = window / 2;
  Strips strips;
  strips.sort(points, half);
  // First where there are two sides at all, by counting: that is cheap.
  std::vector<int> places;  // the step is between strips k - 1 and k
  for (int k = half - shift; k <= half + shift; ++k) {
    if (is_side(strips, k - window, k - kRiserBins, k - window, k - far, parameters.min_cover) &&
        is_side(strips, k + kRiserBins, k + window, k + far, k + window, parameters.min_cover))
      places.push_back(k);
  }
  if (places.empty()) return std::nullopt;
  std::vector<Moments> moments(strips.count.size());
  for (std::size_t b = 0; b < moments.size(); ++b) moments[b].n = strips.count[b];
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (strips.of_point[i] >= 0)
      moments[static_cast<std::size_t>(strips.of_point[i])].add(points.u[i], points.t[i], points.z[i]);
  }
  std::optional<HeightStep> best;
  for (const int k : places) {
    Moments low;
    Moments high;
    for (int b = k - window; b < k - kRiserBins; ++b) low += moments[static_cast<std::size_t>(b)];
    for (int b = k + kRiserBins; b < k + window; ++b) high += moments[static_cast<std::size_t>(b)];
    if (!is_spread(low) || !is_spread(high)) continue;
    const HeightStep step = fit_sides(low, high, (k - half) * kBin, std::max(noise, kNoiseFloor));
    if (!best || step.height * best->sigma > best->height * step.sigma) best = step;
  }
  return best;
}

StepSides look_at_sides(const StepWindow& points, const HeightStep& step, const CurbParameters& parameters) {
  return {.clear = clear_height(points, step, parameters.half_window),
          .foot = find_foot(points, step),
          .face_above = count_face_above(points, step)};
}

}  // namespace curbstone
