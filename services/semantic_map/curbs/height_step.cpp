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
constexpr double kSlopeAcross = 0.30;  // 1 sigma of the slope that both sides share, against the ground's
constexpr double kSlopeAlong = 0.05;
// m, 1 sigma of a point's place, too large rather than too small. Range noise moves a point along its beam, which comes
// in flat: farther is lower. So the few centimetres that a scan line is wide look like ground that falls away from the
// sensor by the beam's own slope, 0.2 to 0.4, and the next line like a step up from there.
constexpr double kPlaceNoise = 0.04;
// Of a step, put down to that noise: two thin sides far apart would leave nothing of it.
constexpr double kMaxMissing = 0.5;
// Of a step, what is there with no slope at all. The ground's own lean (below) takes up to half, over the 0.4 m from
// one side to the other, and noise a little more. The noise within lines that run aslant makes both sides fall, and of
// a step that it made a tenth is left.
constexpr double kMinLevel = 0.4;
constexpr double kOwnLean = 1.2;  // slope of the refined ground about a step, for each m of its height (as measured)

/// What the fits at all places say; `spread` is the smaller variance of u of the two sides.
struct StepFits {
  Places level, spread, height, full_height, roughness, sigma, slope_u, slope_t, low_z;
};

/// Two half-planes at each place (docs/method.md, section 11): of z_0, h and the slope s that both share, those that
/// minimise
///
///     sum_i (z_i - z_0 - s . (u_i, t_i) - h [high side])^2 + n kPlaceNoise^2 |s|^2 + prior_u^2 s_u^2 + prior_t^2 s_t^2
///
/// What the slope against the ground's may be is known beforehand: little along the curb, where thin scan lines that
/// meet the two sides at different places would otherwise trade it for a step; more across, where the ground's own
/// model leans at a curb. A side that is hardly wider than the noise of its points' places says little of it
/// (regression with errors in both variables).
CURBSTONE_VECTORISED
void fit_sides(const Sides& sides, double noise, StepFits& fits) {
  // By fours that lie in a register: of the same on plain numbers GCC does not make that.
  using Four = double __attribute__((vector_size(4 * sizeof(double))));
  const double prior_u = noise / kSlopeAcross;
  const double prior_t = noise / kSlopeAlong;
  for (std::size_t k = 0; k < kPlaces; k += 4) {
    if (!sides.any[k / 4]) continue;
    const auto of = [k](const Places& places) -> const FourPlaces& {
      return reinterpret_cast<const FourPlaces&>(places[k]);
    };
    const auto put = [k](Places& places, const Four& four) { *reinterpret_cast<FourPlaces*>(&places[k]) = four; };
    const Four low_n = of(sides.low.n);
    const Four high_n = of(sides.high.n);
    const Four lu = of(sides.low.u) / low_n;
    const Four lt = of(sides.low.t) / low_n;
    const Four lz = of(sides.low.z) / low_n;
    const Four hu = of(sides.high.u) / high_n;
    const Four ht = of(sides.high.t) / high_n;
    const Four hz = of(sides.high.z) / high_n;
    const Four low_spread = of(sides.low.uu) / low_n - lu * lu;
    const Four high_spread = of(sides.high.uu) / high_n - hu * hu;
    put(fits.spread, low_spread < high_spread ? low_spread : high_spread);
    // Scatter about the means, over both sides.
    const Four by_noise = (low_n + high_n) * kPlaceNoise * kPlaceNoise;
    const Four uu =
        (of(sides.low.uu) - low_n * lu * lu) + (of(sides.high.uu) - high_n * hu * hu) + prior_u * prior_u + by_noise;
    const Four ut = (of(sides.low.ut) - low_n * lu * lt) + (of(sides.high.ut) - high_n * hu * ht);
    const Four tt =
        (of(sides.low.tt) - low_n * lt * lt) + (of(sides.high.tt) - high_n * ht * ht) + prior_t * prior_t + by_noise;
    const Four uz = (of(sides.low.uz) - low_n * lu * lz) + (of(sides.high.uz) - high_n * hu * hz);
    const Four tz = (of(sides.low.tz) - low_n * lt * lz) + (of(sides.high.tz) - high_n * ht * hz);
    const Four zz = (of(sides.low.zz) - low_n * lz * lz) + (of(sides.high.zz) - high_n * hz * hz);
    const Four inverse_det = 1 / (uu * tt - ut * ut);
    const Four inverse_uu = tt * inverse_det;
    const Four inverse_ut = -ut * inverse_det;
    const Four inverse_tt = uu * inverse_det;
    const Four slope_u = inverse_uu * uz + inverse_ut * tz;
    const Four slope_t = inverse_ut * uz + inverse_tt * tz;
    const Four apart_u = hu - lu;
    const Four apart_t = ht - lt;
    put(fits.slope_u, slope_u);
    put(fits.slope_t, slope_t);
    const Four rss = zz - (slope_u * uz + slope_t * tz);
    put(fits.roughness, (0 < rss ? rss : Four{}) / (low_n + high_n - 4) + kNoiseFloor * kNoiseFloor);
    put(fits.level, hz - lz);
    const Four height = hz - lz - (slope_u * apart_u + slope_t * apart_t);
    put(fits.height, height);
    // The heights are above ground that climbs the step within about a metre: against it both sides fall, and as much
    // of that as was put down to noise is missing in the step.
    const Four missing = kOwnLean * by_noise * (inverse_uu * apart_u + inverse_ut * apart_t);
    const Four most = Four{} + kMaxMissing;
    put(fits.full_height, height / (1 - (missing < 0 ? Four{} : missing > most ? most : missing)));
    put(fits.sigma, 1 / low_n + 1 / high_n +
                        (apart_u * (inverse_uu * apart_u + inverse_ut * apart_t) +
                         apart_t * (inverse_ut * apart_u + inverse_tt * apart_t)));
    const auto place = static_cast<double>(k);
    const Four at = (Four{place, place + 1, place + 2, place + 3} - kShift) * kBin;  // step_place()
    put(fits.low_z, lz + slope_u * (at - lu) - slope_t * lt);
  }
}

/// What fit_sides() leaves squared. There, a root that might set errno would keep the loop from going side by side.
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

/// The step of the largest h / sigma_h, among the places where both sides are wide enough.
std::optional<HeightStep> most_certain(const StepFits& fits, const std::array<bool, kPlaces>& exist) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    if (!exist[k] || !(fits.spread[k] >= kMinSpread * kMinSpread)) continue;
    if (!best || fits.height[k] * fits.sigma[*best] > fits.height[*best] * fits.sigma[k]) best = k;
  }
  return best ? std::optional(step_of(fits, *best)) : std::nullopt;
}

/// Of each point its height with the step's slope removed, and which side's it is: -1 the low one's, 1 the high one's,
/// 0 none's.
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

/// A real step parts the heights of its two sides. Where scan lines lie in layers, one of which ends, both layers are
/// found on one side.
double clear_height(const StepWindow& points, const HeightStep& step, double half_window) {
  thread_local std::vector<double> memory;  // for the sake of it
  const std::size_t n = points.size();
  if (memory.size() < 4 * n + 2) memory.resize(4 * n + 2);
  double* const level = memory.data();
  double* const side = level + n;
  double* const low = side + n;
  double* const high = low + n + 1;  // each has room for one more, to be written over
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
  std::int64_t count = 0;  // as wide as a double: so they go side by side
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
