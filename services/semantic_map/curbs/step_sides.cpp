#include "services/semantic_map/curbs/step_sides.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr int kMinPoints = 6;     // a side
constexpr int kMinFarPoints = 3;  // in a side's outer half: ground that continues, not the face of something

constexpr std::size_t kMoments = 9;

using Four = double __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
using Two = double __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));

/// Sums over some points, from which means and scatter follow: one instruction adds to several.
struct Moments {
  Four n_u_t_z;
  Four uu_ut_uz_tt;
  Two tz_zz;
};

static_assert(2 * kShift + 1 <= static_cast<int>(kPlaces));
static_assert(kPlaces % 4 == 0);

/// The window cut into strips along the step: `half` of them on each side of u = 0. The object keeps its memory.
struct Strips {
  /// Dummy strips for points outside all strips. They are used in turn, so that no addition waits for the one before.
  static constexpr int kBeyond = 8;
  int half = 0;
  std::vector<int> of_point;        ///< strip of each point that may belong to a side, else a dummy strip
  std::vector<int> points_before;   ///< number of such points in all strips before each strip
  std::vector<int> covered_before;  ///< number of strips with points before each strip
  std::vector<Moments> moments;     ///< of each strip, and of the dummy strips
  std::vector<double> sums;         ///< the same, moment by moment, so that several places are summed together

  void sum(const StepWindow& points, int num_half);
  void count();
  void arrange();
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(2 * half); }
  /// Distance from one moment to the next in `sums`; the strips of each are followed by kPlaces zeros.
  [[nodiscard]] std::size_t stride() const { return size() + kPlaces; }
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
    strip[i] = is_in ? down + half : 2 * half + static_cast<int>(i % Strips::kBeyond);
  }
}

/// Adds the points of each strip in their order, so that the sums do not depend on the instruction set. The points are
/// counted in the same pass, because a pass of its own would take as long.
CURBSTONE_VECTORISED
void sum_strips(const double* u, const double* t, const double* z, const int* strip, std::size_t n, Moments* moments) {
  for (std::size_t i = 0; i < n; ++i) {
    const Four one_u_t_z{1, u[i], t[i], z[i]};
    Moments& m = moments[strip[i]];
    m.n_u_t_z += one_u_t_z;
    m.uu_ut_uz_tt += __builtin_shufflevector(one_u_t_z, one_u_t_z, 1, 1, 1, 2) *
                     __builtin_shufflevector(one_u_t_z, one_u_t_z, 1, 2, 3, 2);
    m.tz_zz += Two{t[i], z[i]} * Two{z[i], z[i]};
  }
}

void Strips::sum(const StepWindow& points, int num_half) {
  half = num_half;
  const std::size_t n = points.size();
  if (n > of_point.size()) of_point.resize(n);
  find_strips(points.u.data(), points.t.data(), points.unfit.data(), n, points.half_length, half, of_point.data());
  moments.assign(size() + kBeyond, Moments{});
  sum_strips(points.u.data(), points.t.data(), points.z.data(), of_point.data(), n, moments.data());
}

void Strips::count() {
  points_before.resize(size() + 1);
  covered_before.resize(size() + 1);
  points_before[0] = covered_before[0] = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    const int points = static_cast<int>(moments[b].n_u_t_z[0]);
    points_before[b + 1] = points_before[b] + points;
    covered_before[b + 1] = covered_before[b] + (points > 0 ? 1 : 0);
  }
}

void Strips::arrange() {
  const std::size_t apart = stride();
  if (sums.size() != kMoments * apart) sums.assign(kMoments * apart, 0);
  double* const by_moment = sums.data();
  for (std::size_t b = 0; b < size(); ++b) {
    const Moments& m = moments[b];
    const double of_strip[kMoments] = {m.n_u_t_z[1],     m.n_u_t_z[2],     m.n_u_t_z[3],
                                       m.uu_ut_uz_tt[0], m.uu_ut_uz_tt[1], m.uu_ut_uz_tt[3],
                                       m.uu_ut_uz_tt[2], m.tz_zz[0],       m.tz_zz[1]};
    for (std::size_t c = 0; c < kMoments; ++c) by_moment[c * apart + b] = of_strip[c];
  }
}

/// Whether strips `from` to `to` are a side: ground that is covered with points, not one or two scan lines along the
/// step. All points of a scan line may have the same error, which nothing else there would show. The outer half of the
/// side is `far_from` to `far_to`.
bool is_side(const Strips& strips, int from, int to, int far_from, int far_to, double min_cover) {
  return strips.points_in(from, to) >= kMinPoints && strips.points_in(far_from, far_to) >= kMinFarPoints &&
         strips.covered(from, to) >= min_cover * (to - from);
}

/// The strips of the two sides at each place of the step. At place i the step is between strips first + i - 1 and first
/// + i; the sides begin kFaceBins strips from it and end `window` strips from it; their outer halves begin `far` from
/// it.
struct SideStrips {
  int window;
  int far;
  int half;  ///< strips on each side of u = 0
  int first;

  explicit SideStrips(const tile::CurbParameters& parameters)
      : window(static_cast<int>(std::lround(parameters.half_window / kBin))),
        far(window / 2),
        half(window + kShift),
        first(half - kShift) {}
};

void count_sides(const Strips& strips, const SideStrips& at_places, double min_cover, Sides& sides) {
  const auto& [window, far, half, first] = at_places;
  for (int i = 0; i <= 2 * kShift; ++i) {
    const int k = first + i;
    const auto at = static_cast<std::size_t>(i);
    sides.exist[at] = is_side(strips, k - window, k - kFaceBins, k - window, k - far, min_cover) &&
                      is_side(strips, k + kFaceBins, k + window, k + far, k + window, min_cover);
    sides.low.n[at] = strips.points_in(k - window, k - kFaceBins);
    sides.high.n[at] = strips.points_in(k + kFaceBins, k + window);
  }
}

/// The sums over strips `from` .. `to` - 1 for the first place, one strip further for the next, and so on. Only for
/// those fours for which `any` is set.
CURBSTONE_VECTORISED
void sum_side(const double* of_strips, std::size_t stride, std::size_t from, std::size_t to, const bool* any,
              SideSums& side) {
  Places* const moments[kMoments] = {&side.u,  &side.t,  &side.z,  &side.uu, &side.ut,
                                     &side.tt, &side.uz, &side.tz, &side.zz};
  for (std::size_t four = 0; four < kFours; ++four) {
    if (!any[four]) continue;
    Four sums[kMoments] = {};
    for (std::size_t b = from; b < to; ++b) {
      const double* const strip = of_strips + 4 * four + b;
#pragma GCC unroll 9
      for (std::size_t c = 0; c < kMoments; ++c) sums[c] += *reinterpret_cast<const FourPlaces*>(strip + c * stride);
    }
    for (std::size_t c = 0; c < kMoments; ++c) *reinterpret_cast<FourPlaces*>(moments[c]->data() + 4 * four) = sums[c];
  }
}

void sum_sides(const Strips& strips, const SideStrips& at_places, Sides& sides) {
  const auto sum_of = [&](int from, int to, SideSums& side) {
    for (std::size_t i = 2 * kShift + 1; i < kPlaces; ++i) side.n[i] = 0;
    sum_side(strips.sums.data(), strips.stride(), static_cast<std::size_t>(from), static_cast<std::size_t>(to),
             sides.any.data(), side);
  };
  sum_of(at_places.first - at_places.window, at_places.first - kFaceBins, sides.low);
  sum_of(at_places.first + kFaceBins, at_places.first + at_places.window, sides.high);
}

}  // namespace

bool measure_sides(const StepWindow& points, const tile::CurbParameters& parameters, Sides& sides) {
  const SideStrips at_places(parameters);
  thread_local Strips strips;  // keeps its memory for the next call
  strips.sum(points, at_places.half);
  strips.count();
  count_sides(strips, at_places, parameters.min_cover, sides);
  for (std::size_t k = 0; k < kPlaces; ++k) sides.any[k / 4] = sides.any[k / 4] || sides.exist[k];
  if (std::none_of(sides.any.begin(), sides.any.end(), [](bool any) { return any; })) return false;
  strips.arrange();
  sum_sides(strips, at_places, sides);
  return true;
}

}  // namespace curbstone::semantic_map::curbs
