#include "services/semantic_map/curbs/height_step.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
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
    fits.slope_u[k] = slope_u;
    fits.slope_t[k] = slope_t;
    const double rss = zz - (slope_u * uz + slope_t * tz);
    fits.roughness[k] = (0 < rss ? rss : 0) / (low.n[k] + high.n[k] - 4) + kNoiseFloor * kNoiseFloor;
    fits.level[k] = hz - lz;
    fits.height[k] = hz - lz - (slope_u * apart_u + slope_t * apart_t);
    // The heights are above ground that climbs the step within about a metre: against it both sides fall, and as much
    // of that as was put down to noise is missing in the step.
    const double missing = kOwnLean * by_noise * (inverse_uu * apart_u + inverse_ut * apart_t);
    fits.full_height[k] = fits.height[k] / (1 - (missing < 0 ? 0 : missing > kMaxMissing ? kMaxMissing : missing));
    fits.sigma[k] = 1 / low.n[k] + 1 / high.n[k] +
                    (apart_u * (inverse_uu * apart_u + inverse_ut * apart_t) +
                     apart_t * (inverse_ut * apart_u + inverse_tt * apart_t));
    fits.low_z[k] = lz + slope_u * (step_place(k) - lu) - slope_t * lt;
  }
}

/// What fit_sides() leaves squared. There, a root that might set errno would keep the loop from going side by side.
void take_roots(StepFits& fits) {
  Eigen::Map<Eigen::Array<double, kPlaces, 1>> roughness(fits.roughness.data());
  Eigen::Map<Eigen::Array<double, kPlaces, 1>> sigma(fits.sigma.data());
  roughness = roughness.sqrt();
  sigma = roughness * sigma.sqrt();
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
  Sides sides;
  if (!measure_sides(points, parameters, sides)) return std::nullopt;
  StepFits fits;
  fit_sides(sides.low, sides.high, std::max(noise, kNoiseFloor), fits);
  take_roots(fits);
  return most_certain(fits, sides.exist);
}

StepSides evaluate_sides(const StepWindow& points, const HeightStep& step, const tile::CurbParameters& parameters) {
  return {.clear = clear_height(points, step, parameters.half_window), .face_above = count_face_above(points, step)};
}

}  // namespace curbstone::semantic_map::curbs
