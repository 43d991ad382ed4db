#pragma once

#include <array>
#include <cstddef>

#include "services/semantic_map/curbs/height_step.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"

namespace curbstone::semantic_map::curbs {

inline constexpr double kBin = 0.03;       ///< m in u: spacing of the places at which a step is tried
inline constexpr int kFaceBins = 1;        ///< on each side of the step: left out of the fit, as they are of the face
inline constexpr double kMaxShift = 0.18;  ///< m: how far from u = 0 the step may be
inline constexpr int kShift = static_cast<int>(kMaxShift / kBin + 0.5);
inline constexpr std::size_t kPlaces = 16;  ///< 2 kShift + 1 places of the step, rounded up to a multiple of four

/// Position of a place, m in u.
[[nodiscard]] constexpr double step_place(std::size_t k) {
  return (static_cast<int>(k) - kShift) * kBin;
}

/// One value for each place; all places are computed together.
using Places = std::array<double, kPlaces>;

/// Moments of one side, for each place of the step; undefined where there is no side.
struct SideSums {
  Places n, u, t, z, uu, ut, tt, uz, tz, zz;
};

/// Places are computed in fours.
inline constexpr std::size_t kFours = kPlaces / 4;
/// Four Places, as a vector register holds them, at any address.
using FourPlaces = double __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));

/// Both sides at each place, and whether they exist. Fours in which no place has two sides are not computed.
struct Sides {
  std::array<bool, kPlaces> exist{};
  std::array<bool, kFours> any{};  ///< of the four places
  SideSums low;
  SideSums high;
};

/// Fills `sides` with the sums over the points of a window on both sides of each place. False if no place has two
/// sides, which is found by counting, before anything is summed.
[[nodiscard]] bool measure_sides(const StepWindow& points, const tile::CurbParameters& parameters, Sides& sides);

}  // namespace curbstone::semantic_map::curbs
