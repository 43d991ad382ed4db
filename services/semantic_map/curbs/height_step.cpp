#include "services/semantic_map/curbs/height_step.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "common/statistics/quantile.hpp"
#include "services/semantic_map/curbs/vectorised.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kBin = 0.03;          // m in u: the step is sought at this grain
constexpr int kFaceBins = 1;           // on each side of the step: left out of the fit, the face's own points
constexpr double kMaxShift = 0.18;     // m: how far from u = 0 the step may be
constexpr int kMinPoints = 6;          // a side
constexpr int kMinFarPoints = 3;       // in a side's outer half: ground that goes on, not the face of something
constexpr double kMinSpread = 0.05;    // m, standard deviation of u on a side: a thin line of points is no side
constexpr double kNoiseFloor = 0.004;  // m
constexpr double kSlopeAcross = 0.30;  // 1 sigma of the slope that both sides share, against the ground's
constexpr double kSlopeAlong = 0.05;
// m, 1 sigma of a point's place, too large rather than too small. Range noise moves a point along its beam, which comes
// in flat: farther is lower. So the few centimetres that a scan line is wide look like ground that falls away from the
// sensor by the beam's own slope, 0.2 to 0.4, and the next line like a step up from there.
constexpr double kPlaceNoise = 0.04;
// Of a step, put down to that noise: two thin sides far apart would leave nothing of it.
constexpr double kMostMissing = 0.5;
// Of a step, what is there with no slope at all. The ground's own lean (below) takes up to half, over the 0.4 m from
// one side to the other, and noise a little more. The noise within lines that run aslant makes both sides fall, and of
// a step that it made a tenth is left.
constexpr double kMinLevel = 0.4;
constexpr double kOwnLean = 1.2;  // slope of the refined ground about a step, for each m of its height (as measured)

/// Two sums that are kept in step: one instruction adds to both.
using Pair = Eigen::Array2d;

constexpr std::size_t kMoments = 9;

/// Sums over some points, from which means and scatter follow: kMoments of them.
struct Moments {
  Pair t_z = Pair::Zero(), uu_ut = Pair::Zero(), tt_uz = Pair::Zero(), tz_zz = Pair::Zero();
  double u = 0;

  void add(double at_u, double t, double z) {
    const Pair tz(t, z);
    u += at_u;
    t_z += tz;
    uu_ut += Pair(at_u, at_u) * Pair(at_u, t);
    tt_uz += Pair(t, at_u) * tz;
    tz_zz += Pair(z, z) * tz;
  }
};

constexpr int kShift = static_cast<int>(kMaxShift / kBin + 0.5);
constexpr int kPlaces = 16;  // at which the step may be: 2 kShift + 1, made even
static_assert(2 * kShift + 1 <= kPlaces);
using Places = std::array<double, kPlaces>;
/// A register's worth, wherever it lies. Of a plain loop over the places GCC makes one over strips, with shuffles in
/// between.
using FourPlaces = double __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
static_assert(kPlaces == 16);

/// m in u.
constexpr double place(int k) {
  return (k - kShift) * kBin;
}

/// The window cut into strips along the step: `half` of them on each side of u = 0. Kept for the sake of its memory.
struct Strips {
  int half = 0;
  std::vector<int> of_point;         ///< strip of each point that may carry a side, else -1
  std::vector<std::uint32_t> order;  ///< those points, once they are summed up
  std::vector<int> points_before;    ///< of them, in all strips before each
  std::vector<int> covered_before;   ///< strips with points, before each
  std::vector<Moments> moments;      ///< of each strip
  std::vector<double> sums;          ///< the same, moment by moment, so that many places are summed up side by side

  void sort(const StepWindow& points, int num_half);
  void sum(const StepWindow& points);
  /// From one moment to the next; behind a moment's strips are as many zeros as may be read there.
  [[nodiscard]] std::size_t stride() const { return static_cast<std::size_t>(2 * half + kPlaces); }
  [[nodiscard]] int points_in(int from, int to) const {
    return points_before[static_cast<std::size_t>(to)] - points_before[static_cast<std::size_t>(from)];
  }
  [[nodiscard]] int covered(int from, int to) const {
    return covered_before[static_cast<std::size_t>(to)] - covered_before[static_cast<std::size_t>(from)];
  }
};

CURBSTONE_VECTORISED
void find_strips(const double* u, const double* t, const double* unfit, std::size_t n, double half_length, int half,
                 int* strip) {
  for (std::size_t i = 0; i < n; ++i) {
    const double q = u[i] / kBin;
    const int towards_zero = static_cast<int>(q);
    const int down = towards_zero - (towards_zero > q ? 1 : 0);
    const bool is_in = (std::abs(t[i]) + unfit[i] <= half_length) & (down >= -half) & (down < half);
    strip[i] = is_in ? down + half : -1;
  }
}

void Strips::sort(const StepWindow& points, int num_half) {
  half = num_half;
  const std::size_t n = points.size();
  if (n > of_point.size()) of_point.resize(n);
  find_strips(points.u.data(), points.t.data(), points.unfit.data(), n, points.half_length, half, of_point.data());
  points_before.assign(static_cast<std::size_t>(2 * half) + 1, 0);
  covered_before.resize(points_before.size());
  for (std::size_t i = 0; i < n; ++i) ++points_before[static_cast<std::size_t>(of_point[i] + 1)];
  points_before[0] = covered_before[0] = 0;  // those that are in no strip
  for (std::size_t b = 1; b < points_before.size(); ++b) {
    covered_before[b] = covered_before[b - 1] + (points_before[b] > 0 ? 1 : 0);
    points_before[b] += points_before[b - 1];
  }
}

void Strips::sum(const StepWindow& points) {
  moments.assign(static_cast<std::size_t>(2 * half), Moments{});
  const double* const u = points.u.data();
  const double* const t = points.t.data();
  const double* const z = points.z.data();
  order.resize(static_cast<std::size_t>(points_before.back()) + 1);  // one more, to be written over
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    order[kept] = static_cast<std::uint32_t>(i);
    kept += of_point[i] >= 0 ? 1U : 0U;
  }
  order.resize(kept);
  for (const std::uint32_t i : order) moments[static_cast<std::size_t>(of_point[i])].add(u[i], t[i], z[i]);
  const std::size_t apart = stride();
  if (sums.size() != kMoments * apart) sums.assign(kMoments * apart, 0);
  for (std::size_t b = 0; b < moments.size(); ++b) {
    const Moments& m = moments[b];
    const double of_strip[kMoments] = {m.u,        m.t_z(0),   m.t_z(1),   m.uu_ut(0), m.uu_ut(1),
                                       m.tt_uz(0), m.tt_uz(1), m.tz_zz(0), m.tz_zz(1)};
    for (std::size_t c = 0; c < kMoments; ++c) sums[c * apart + b] = of_strip[c];
  }
}

/// A side is ground seen all over, not a scan line or two that run along the step: all points of a line may be off by
/// the same, and nothing else there would say so. Its outer half is from `far_from` to `far_to`.
bool is_side(const Strips& strips, int from, int to, int far_from, int far_to, double min_cover) {
  return strips.points_in(from, to) >= kMinPoints && strips.points_in(far_from, far_to) >= kMinFarPoints &&
         strips.covered(from, to) >= min_cover * (to - from);
}

/// Moments of one side, for each place of the step; where there is no side they mean nothing.
struct SideSums {
  Places n, u, t, z, uu, ut, tt, uz, tz, zz;
};

/// The sums over strips `from` .. `to` - 1 of the first place, one on of the next.
CURBSTONE_VECTORISED
void sum_side(const double* of_strips, std::size_t stride, std::size_t from, std::size_t to, SideSums& side) {
  Places* const moments[kMoments] = {&side.u,  &side.t,  &side.z,  &side.uu, &side.ut,
                                     &side.tt, &side.uz, &side.tz, &side.zz};
  for (std::size_t c = 0; c < kMoments; ++c) {
    FourPlaces first{};
    FourPlaces second{};
    FourPlaces third{};
    FourPlaces fourth{};
    for (std::size_t b = from; b < to; ++b) {
      const auto* const strip = reinterpret_cast<const FourPlaces*>(of_strips + c * stride + b);
      first += strip[0];
      second += strip[1];
      third += strip[2];
      fourth += strip[3];
    }
    auto* const sums = reinterpret_cast<FourPlaces*>(moments[c]->data());
    sums[0] = first;
    sums[1] = second;
    sums[2] = third;
    sums[3] = fourth;
  }
}

/// What the fits at all places say; `spread` is the smaller variance of u of the two sides.
struct StepFits {
  Places level, spread, height, full_height, rss, scale, slope_u, slope_t, low_z, n;
};

/// Two half-planes at each place. What the slope against the ground's may be is known beforehand: little along the
/// curb, where thin scan lines that meet the two sides at different places would otherwise trade it for a step; more
/// across, where the ground's own model leans at a curb. A side that is hardly wider than the noise of its points'
/// places says little of it (regression with errors in both variables).
CURBSTONE_VECTORISED
void fit_sides(const SideSums& low, const SideSums& high, double noise, StepFits& fits) {
  const double prior_u = noise / kSlopeAcross;
  const double prior_t = noise / kSlopeAlong;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const double lu = low.u[k] / low.n[k];
    const double lt = low.t[k] / low.n[k];
    const double lz = low.z[k] / low.n[k];
    const double hu = high.u[k] / high.n[k];
    const double ht = high.t[k] / high.n[k];
    const double hz = high.z[k] / high.n[k];
    const double low_spread = low.uu[k] / low.n[k] - lu * lu;
    const double high_spread = high.uu[k] / high.n[k] - hu * hu;
    fits.spread[k] = low_spread < high_spread ? low_spread : high_spread;
    // Scatter about the means, over both sides.
    const double by_noise = (low.n[k] + high.n[k]) * kPlaceNoise * kPlaceNoise;
    const double uu =
        (low.uu[k] - low.n[k] * lu * lu) + (high.uu[k] - high.n[k] * hu * hu) + prior_u * prior_u + by_noise;
    const double ut = (low.ut[k] - low.n[k] * lu * lt) + (high.ut[k] - high.n[k] * hu * ht);
    const double tt =
        (low.tt[k] - low.n[k] * lt * lt) + (high.tt[k] - high.n[k] * ht * ht) + prior_t * prior_t + by_noise;
    const double uz = (low.uz[k] - low.n[k] * lu * lz) + (high.uz[k] - high.n[k] * hu * hz);
    const double tz = (low.tz[k] - low.n[k] * lt * lz) + (high.tz[k] - high.n[k] * ht * hz);
    const double zz = (low.zz[k] - low.n[k] * lz * lz) + (high.zz[k] - high.n[k] * hz * hz);
    const double inverse_det = 1 / (uu * tt - ut * ut);
    const double inverse_uu = tt * inverse_det;
    const double inverse_ut = -ut * inverse_det;
    const double inverse_tt = uu * inverse_det;
    const double slope_u = inverse_uu * uz + inverse_ut * tz;
    const double slope_t = inverse_ut * uz + inverse_tt * tz;
    const double apart_u = hu - lu;
    const double apart_t = ht - lt;
    fits.n[k] = low.n[k] + high.n[k];
    fits.slope_u[k] = slope_u;
    fits.slope_t[k] = slope_t;
    fits.rss[k] = zz - (slope_u * uz + slope_t * tz);
    fits.level[k] = hz - lz;
    fits.height[k] = hz - lz - (slope_u * apart_u + slope_t * apart_t);
    // The heights are above ground that climbs the step within about a metre: against it both sides fall, and as much
    // of that as was put down to noise is missing in the step.
    const double missing = kOwnLean * by_noise * (inverse_uu * apart_u + inverse_ut * apart_t);
    fits.full_height[k] = fits.height[k] / (1 - (missing < 0 ? 0 : missing > kMostMissing ? kMostMissing : missing));
    fits.scale[k] = 1 / low.n[k] + 1 / high.n[k] +
                    (apart_u * (inverse_uu * apart_u + inverse_ut * apart_t) +
                     apart_t * (inverse_ut * apart_u + inverse_tt * apart_t));
    fits.low_z[k] = lz + slope_u * (place(static_cast<int>(k)) - lu) - slope_t * lt;
  }
}

HeightStep step_of(const StepFits& fits, std::size_t k) {
  HeightStep step;
  step.at = place(static_cast<int>(k));
  step.height = fits.height[k];
  step.level = fits.level[k];
  step.full_height = fits.full_height[k];
  step.roughness = std::sqrt(std::max(0.0, fits.rss[k]) / (fits.n[k] - 4) + kNoiseFloor * kNoiseFloor);
  step.sigma = step.roughness * std::sqrt(fits.scale[k]);
  step.low_z = fits.low_z[k];
  step.slope = {fits.slope_u[k], fits.slope_t[k]};
  return step;
}

/// A real step parts the heights of its two sides. Where scan lines lie in layers, one of which ends, both layers are
/// found on one side.
double clear_height(const StepWindow& points, const HeightStep& step, double half_window) {
  thread_local std::vector<double> low;  // for the sake of their memory
  thread_local std::vector<double> high;
  low.clear();
  high.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = points.u[i] - step.at;
    if (!points.may_carry_a_side(i) || std::abs(u) > half_window || std::abs(u) < kFaceBins * kBin) continue;
    (u < 0 ? low : high).push_back(points.z[i] - step.slope.x() * u - step.slope.y() * points.t[i]);
  }
  if (low.empty() || high.empty()) return 0;
  return quantile_in_place(high, 0.2) - quantile_in_place(low, 0.8);
}

int count_face_above(const StepWindow& points, const HeightStep& step) {
  constexpr double kNear = 0.12;   // m on each side of the step
  constexpr double kAbove = 0.10;  // m above its upper edge
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.has(i) && std::abs(points.u[i] - step.at) < kNear && points.z[i] > step.low_z + step.height + kAbove)
      ++count;
  }
  return count;
}

}  // namespace

void StepWindow::resize(std::size_t n) {
  num_points = n;
  if (n <= u.size()) return;
  for (std::vector<double>* column : {&u, &t, &z, &unfit}) column->resize(n);
}

void StepWindow::add(double at_u, double at_t, double at_z, bool is_ground) {
  const std::size_t i = num_points;
  resize(i + 1);
  u[i] = at_u;
  t[i] = at_t;
  z[i] = at_z;
  unfit[i] = is_ground ? 0 : kUnfit;
}

bool HeightStep::falls() const {
  return level < kMinLevel * height;
}

std::optional<HeightStep> find_height_step(const StepWindow& points, double noise,
                                           const tile::CurbParameters& parameters) {
  const int window = static_cast<int>(std::lround(parameters.half_window / kBin));
  const int half = window + kShift;
  const int far = window / 2;
  const int first = half - kShift;  // the step is between strips k - 1 and k, this k and the next ones
  thread_local Strips strips;
  strips.sort(points, half);
  // First where there are two sides at all, by counting: that is cheap.
  std::array<bool, kPlaces> has_sides{};
  SideSums low;
  SideSums high;
  for (int i = 0; i <= 2 * kShift; ++i) {
    const int k = first + i;
    const auto at = static_cast<std::size_t>(i);
    has_sides[at] = is_side(strips, k - window, k - kFaceBins, k - window, k - far, parameters.min_cover) &&
                    is_side(strips, k + kFaceBins, k + window, k + far, k + window, parameters.min_cover);
    low.n[at] = strips.points_in(k - window, k - kFaceBins);
    high.n[at] = strips.points_in(k + kFaceBins, k + window);
  }
  if (std::none_of(has_sides.begin(), has_sides.end(), [](bool has) { return has; })) return std::nullopt;
  strips.sum(points);
  const auto sum_of = [&](int from, int to, SideSums& side) {
    for (std::size_t i = 2 * kShift + 1; i < kPlaces; ++i) side.n[i] = 0;
    sum_side(strips.sums.data(), strips.stride(), static_cast<std::size_t>(from), static_cast<std::size_t>(to), side);
  };
  sum_of(first - window, first - kFaceBins, low);
  sum_of(first + kFaceBins, first + window, high);
  StepFits fits;
  fit_sides(low, high, std::max(noise, kNoiseFloor), fits);
  std::optional<HeightStep> best;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    if (!has_sides[i] || !(fits.spread[i] >= kMinSpread * kMinSpread)) continue;
    const HeightStep step = step_of(fits, i);
    if (!best || step.height * best->sigma > best->height * step.sigma) best = step;
  }
  return best;
}

StepSides look_at_sides(const StepWindow& points, const HeightStep& step, const tile::CurbParameters& parameters) {
  return {.clear = clear_height(points, step, parameters.half_window), .face_above = count_face_above(points, step)};
}

}  // namespace curbstone::semantic_map::curbs
