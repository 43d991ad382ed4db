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
constexpr int kMinFarPoints = 3;  // in a side's outer half: ground that goes on, not the face of something

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

static_assert(2 * kShift + 1 <= static_cast<int>(kPlaces));
/// A register's worth, wherever it lies. Of a plain loop over the places GCC makes one over strips, with shuffles in
/// between.
using FourPlaces = double __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
static_assert(kPlaces == 16);

/// The window cut into strips along the step: `half` of them on each side of u = 0. Kept for the sake of its memory.
struct Strips {
  int half = 0;
  std::vector<int> of_point;         ///< strip of each point that may carry a side, else -1
  std::vector<std::uint32_t> order;  ///< those points, once they are summed up
  std::vector<int> points_before;    ///< of them, in all strips before each
  std::vector<int> covered_before;   ///< strips with points, before each
  std::vector<Moments> moments;      ///< of each strip
  std::vector<double> sums;          ///< the same, moment by moment, so that many places are summed up side by side

  std::vector<int> odd_points;  ///< scratch

  void sort(const StepWindow& points, int num_half);
  void count(std::size_t n);
  void sum(const StepWindow& points);
  /// From one moment to the next; behind a moment's strips are as many zeros as may be read there.
  [[nodiscard]] std::size_t stride() const { return static_cast<std::size_t>(2 * half) + kPlaces; }
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

/// Points side by side are often of one strip, and to count one would wait for the one before: so every other one is
/// counted apart.
void Strips::count(std::size_t n) {
  odd_points.assign(points_before.size(), 0);
  const int* const strip = of_point.data();
  int* const even = points_before.data() + 1;
  int* const odd = odd_points.data() + 1;
  std::size_t i = 0;
  for (; i + 1 < n; i += 2) {
    ++even[strip[i]];
    ++odd[strip[i + 1]];
  }
  if (i < n) ++even[strip[i]];
  for (std::size_t b = 0; b < points_before.size(); ++b) points_before[b] += odd_points[b];
}

void Strips::sort(const StepWindow& points, int num_half) {
  half = num_half;
  const std::size_t n = points.size();
  if (n > of_point.size()) of_point.resize(n);
  find_strips(points.u.data(), points.t.data(), points.unfit.data(), n, points.half_length, half, of_point.data());
  points_before.assign(static_cast<std::size_t>(2 * half) + 1, 0);
  covered_before.resize(points_before.size());
  count(n);
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

/// Which strips are the sides' at each place of the step. At place i it is between strips first + i - 1 and first + i;
/// the sides begin kFaceBins from it and end `window` from it, and their outer halves begin `far` from it.
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

void sum_sides(const Strips& strips, const SideStrips& at_places, Sides& sides) {
  const auto sum_of = [&](int from, int to, SideSums& side) {
    for (std::size_t i = 2 * kShift + 1; i < kPlaces; ++i) side.n[i] = 0;
    sum_side(strips.sums.data(), strips.stride(), static_cast<std::size_t>(from), static_cast<std::size_t>(to), side);
  };
  sum_of(at_places.first - at_places.window, at_places.first - kFaceBins, sides.low);
  sum_of(at_places.first + kFaceBins, at_places.first + at_places.window, sides.high);
}

}  // namespace

bool measure_sides(const StepWindow& points, const tile::CurbParameters& parameters, Sides& sides) {
  const SideStrips at_places(parameters);
  thread_local Strips strips;  // for the sake of its memory
  strips.sort(points, at_places.half);
  count_sides(strips, at_places, parameters.min_cover, sides);
  if (std::none_of(sides.exist.begin(), sides.exist.end(), [](bool exist) { return exist; })) return false;
  strips.sum(points);
  sum_sides(strips, at_places, sides);
  return true;
}

}  // namespace curbstone::semantic_map::curbs
