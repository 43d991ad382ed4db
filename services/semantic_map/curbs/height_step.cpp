#include "services/semantic_map/curbs/height_step.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/statistics/quantile.hpp"
#include "services/semantic_map/curbs/step_sides.hpp"
#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kMinSpread = 0.05;    // m, standard deviation of u on a side: a thin line of points is no side
constexpr double kNoiseFloor = 0.004;  // m
constexpr double kSlopeAcross = 0.30;  // 1 sigma of the slope that both sides share, relative to the ground's
constexpr double kSlopeAlong = 0.05;   // likewise, along the curb
// m, 1 sigma of a point's position, rather too large than too small. Range noise moves a point along its beam, which
// meets the ground at a small angle: farther is lower. So the few centimetres of a scan line's width look like ground
// that falls away from the sensor with the slope of the beam, 0.2 to 0.4, and the next line looks like a step up.
constexpr double kPlaceNoise = 0.04;
// Largest share of a step that is attributed to that noise. Without a limit nothing would be left between two thin
// sides that are far apart.
constexpr double kMaxMissing = 0.5;
// Least share of a step that must remain without any slope. The lean of the DEM (below) takes up to half of it, over
// the 0.4 m from one side to the other, and noise a little more. Noise within oblique scan lines makes both sides fall:
// of a step that it causes, a tenth remains.
constexpr double kMinLevel = 0.4;
constexpr double kOwnLean = 1.2;  // slope of the DEM at a step, for each m of the step's height (measured)

/// The fits at all places; `spread` is the smaller of the two sides' variances of u.
struct StepFits {
  Places level, spread, height, full_height, roughness, sigma, slope_u, slope_t, low_z;
};

// Four places in a vector register. GCC does not vectorise the same code on plain numbers.
using Quad = double __attribute__((vector_size(4 * sizeof(double))));

[[gnu::always_inline]] inline const FourPlaces& four_of(const Places& places, std::size_t k) {
  return reinterpret_cast<const FourPlaces&>(places[k]);
}

/// The number and the means of a side's points, and the variance of their u.
struct SideMeans {
  Quad n, u, t, z, spread;
  [[gnu::always_inline]] SideMeans(const SideSums& side, std::size_t k)
      : n(four_of(side.n, k)),
        u(four_of(side.u, k) / n),
        t(four_of(side.t, k) / n),
        z(four_of(side.z, k) / n),
        spread(four_of(side.uu, k) / n - u * u) {}
};

/// Scatter about the means, over both sides. That of (u, t) is S of docs/method.md, including the terms that keep the
/// slope small: `place`, which is n kPlaceNoise^2, and the squares of the priors.
struct Scatter {
  Quad uu, ut, tt, uz, tz, zz;
  [[gnu::always_inline]] Scatter(const Sides& sides, std::size_t k, const SideMeans& l, const SideMeans& h,
                                 const Quad& place, double prior_u, double prior_t)
      : uu((four_of(sides.low.uu, k) - l.n * l.u * l.u) + (four_of(sides.high.uu, k) - h.n * h.u * h.u) +
           prior_u * prior_u + place),
        ut((four_of(sides.low.ut, k) - l.n * l.u * l.t) + (four_of(sides.high.ut, k) - h.n * h.u * h.t)),
        tt((four_of(sides.low.tt, k) - l.n * l.t * l.t) + (four_of(sides.high.tt, k) - h.n * h.t * h.t) +
           prior_t * prior_t + place),
        uz((four_of(sides.low.uz, k) - l.n * l.u * l.z) + (four_of(sides.high.uz, k) - h.n * h.u * h.z)),
        tz((four_of(sides.low.tz, k) - l.n * l.t * l.z) + (four_of(sides.high.tz, k) - h.n * h.t * h.z)),
        zz((four_of(sides.low.zz, k) - l.n * l.z * l.z) + (four_of(sides.high.zz, k) - h.n * h.z * h.z)) {}
};

/// The inverse of S.
struct Inverse {
  Quad uu, ut, tt;
  [[gnu::always_inline]] explicit Inverse(const Scatter& S) {
    const Quad inverse_det = 1 / (S.uu * S.tt - S.ut * S.ut);
    uu = S.tt * inverse_det;
    ut = -S.ut * inverse_det;
    tt = S.uu * inverse_det;
  }
};

/// Fits two half-planes at each place (docs/method.md, section 11): z_0, h and the shared slope s that minimise
///
///     sum_i (z_i - z_0 - s . (u_i, t_i) - h [high side])^2 + n kPlaceNoise^2 |s|^2 + prior_u^2 s_u^2 + prior_t^2 s_t^2
///
/// The priors bound the slope relative to the DEM. Along the curb it is small: otherwise thin scan lines that meet the
/// two sides at different places would trade slope for a step. Across the curb it may be larger, because the DEM leans
/// at a curb. A side that is hardly wider than the position noise of its points determines the slope badly, which the
/// term of kPlaceNoise accounts for (regression with errors in both variables).
CURBSTONE_VECTORISED
void fit_sides(const Sides& sides, double noise, StepFits& fits) {
  const double prior_u = noise / kSlopeAcross;
  const double prior_t = noise / kSlopeAlong;
  for (std::size_t k = 0; k < kPlaces; k += 4) {
    if (!sides.any[k / 4]) continue;
    const auto put = [k](Places& places, const Quad& four) { *reinterpret_cast<FourPlaces*>(&places[k]) = four; };
    const SideMeans low(sides.low, k);
    const SideMeans high(sides.high, k);
    put(fits.spread, low.spread < high.spread ? low.spread : high.spread);
    const Quad place = (low.n + high.n) * kPlaceNoise * kPlaceNoise;
    const Scatter S(sides, k, low, high, place, prior_u, prior_t);
    const Inverse inverse(S);
    const Quad slope_u = inverse.uu * S.uz + inverse.ut * S.tz;
    const Quad slope_t = inverse.ut * S.uz + inverse.tt * S.tz;
    put(fits.slope_u, slope_u);
    put(fits.slope_t, slope_t);
    const Quad rss = S.zz - (slope_u * S.uz + slope_t * S.tz);
    put(fits.roughness, (0 < rss ? rss : Quad{}) / (low.n + high.n - 4) + kNoiseFloor * kNoiseFloor);
    // The step is what remains of the difference of the means; its variance is in units of that of the residuals.
    const Quad apart_u = high.u - low.u;
    const Quad apart_t = high.t - low.t;
    put(fits.level, high.z - low.z);
    const Quad height = high.z - low.z - (slope_u * apart_u + slope_t * apart_t);
    put(fits.height, height);
    const Quad along_u = inverse.uu * apart_u + inverse.ut * apart_t;  // S^-1 a
    const Quad along_t = inverse.ut * apart_u + inverse.tt * apart_t;
    put(fits.sigma, 1 / low.n + 1 / high.n + (apart_u * along_u + apart_t * along_t));
    // Heights are relative to the DEM, which climbs the step within about a metre. Relative to it both sides fall. The
    // part of this fall that was attributed to noise is missing in the step.
    const Quad missing = kOwnLean * place * along_u;
    const Quad most = Quad{} + kMaxMissing;
    put(fits.full_height, height / (1 - (missing < 0 ? Quad{} : missing > most ? most : missing)));
    const auto first = static_cast<double>(k);
    const Quad at = (Quad{first, first + 1, first + 2, first + 3} - kShift) * kBin;  // step_place()
    put(fits.low_z, low.z + slope_u * (at - low.u) - slope_t * low.t);
  }
}

/// Takes the roots of what fit_sides() leaves squared. There, a root that may set errno would prevent vectorisation.
void take_roots(const Sides& sides, StepFits& fits) {
  for (std::size_t four = 0; four < kFours; ++four) {
    if (!sides.any[four]) continue;
    Eigen::Map<Eigen::Array4d> roughness(fits.roughness.data() + 4 * four);
    Eigen::Map<Eigen::Array4d> sigma(fits.sigma.data() + 4 * four);
    roughness = roughness.sqrt();
    sigma = roughness * sigma.sqrt();
  }
}

HeightStep step_of(const StepFits& fits, std::size_t k) {
  HeightStep step;
  step.at = step_place(k);
  step.height = fits.height[k];
  step.level = fits.level[k];
  step.full_height = fits.full_height[k];
  step.roughness = fits.roughness[k];
  step.sigma = fits.sigma[k];
  step.low_z = fits.low_z[k];
  step.slope = {fits.slope_u[k], fits.slope_t[k]};
  return step;
}

/// The step with the largest h / sigma_h, among the places where both sides are wide enough.
std::optional<HeightStep> most_certain(const StepFits& fits, const std::array<bool, kPlaces>& exist) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    if (!exist[k] || !(fits.spread[k] >= kMinSpread * kMinSpread)) continue;
    if (!best || fits.height[k] * fits.sigma[*best] > fits.height[*best] * fits.sigma[k]) best = k;
  }
  return best ? std::optional(step_of(fits, *best)) : std::nullopt;
}

/// The height of each point with the step's slope removed, and its side: -1 the low one, 1 the high one, 0 neither.
CURBSTONE_VECTORISED
void level_sides(const double* u, const double* t, const double* z, const double* unfit, std::size_t n,
                 double half_length, const HeightStep& step, double half_window, double* __restrict level,
                 double* __restrict side) {
  const double at = step.at;
  const double slope_u = step.slope.x();
  const double slope_t = step.slope.y();
  for (std::size_t i = 0; i < n; ++i) {
    const double from = u[i] - at;
    const double away = std::abs(from);
    level[i] = z[i] - slope_u * from - slope_t * t[i];
    const bool counts = (std::abs(t[i]) + unfit[i] <= half_length) & (away <= half_window) & (away >= kFaceBins * kBin);
    side[i] = counts ? (from < 0 ? -1.0 : 1.0) : 0.0;
  }
}

/// The height by which the two sides are separated. A real step separates them. Where scan lines lie in two layers, one
/// of which ends, both layers are on one side, and nothing is separated.
double clear_height(const StepWindow& points, const HeightStep& step, double half_window) {
  thread_local std::vector<double> memory;  // kept for the next call
  const std::size_t n = points.size();
  if (memory.size() < 4 * n + 2) memory.resize(4 * n + 2);
  double* const level = memory.data();
  double* const side = level + n;
  double* const low = side + n;
  double* const high = low + n + 1;  // both have room for one more value, which the next one overwrites
  level_sides(points.u.data(), points.t.data(), points.z.data(), points.unfit.data(), n, points.half_length, step,
              half_window, level, side);
  std::size_t num_low = 0;
  std::size_t num_high = 0;
  for (std::size_t i = 0; i < n; ++i) {
    low[num_low] = level[i];
    high[num_high] = level[i];
    num_low += side[i] < 0 ? 1U : 0U;
    num_high += side[i] > 0 ? 1U : 0U;
  }
  if (num_low == 0 || num_high == 0) return 0;
  return quantile_in_place({high, num_high}, 0.2) - quantile_in_place({low, num_low}, 0.8);
}

CURBSTONE_VECTORISED
int count_above(const double* u, const double* t, const double* z, std::size_t n, double half_length, double at,
                double near, double above) {
  std::int64_t count = 0;  // as wide as a double, so that the loop is vectorised
  for (std::size_t i = 0; i < n; ++i)
    count += ((std::abs(t[i]) <= half_length) & (std::abs(u[i] - at) < near) & (z[i] > above)) ? 1 : 0;
  return static_cast<int>(count);
}

int count_face_above(const StepWindow& points, const HeightStep& step) {
  constexpr double kNear = 0.12;   // m on each side of the step
  constexpr double kAbove = 0.10;  // m above its upper edge
  return count_above(points.u.data(), points.t.data(), points.z.data(), points.size(), points.half_length, step.at,
                     kNear, step.low_z + step.height + kAbove);
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
  Sides sides;
  if (!measure_sides(points, parameters, sides)) return std::nullopt;
  StepFits fits;
  fit_sides(sides, std::max(noise, kNoiseFloor), fits);
  take_roots(sides, fits);
  return most_certain(fits, sides.exist);
}

StepSides evaluate_sides(const StepWindow& points, const HeightStep& step, const tile::CurbParameters& parameters) {
  return {.clear = clear_height(points, step, parameters.half_window), .face_above = count_face_above(points, step)};
}

}  // namespace curbstone::semantic_map::curbs
