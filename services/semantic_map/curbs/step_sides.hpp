#pragma once

#include <array>
#include <cstddef>

#include "services/semantic_map/curbs/height_step.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"

namespace curbstone::semantic_map::curbs {

inline constexpr double kBin = 0.03;       ///< m in u: the step is sought at this grain
inline constexpr int kFaceBins = 1;        ///< on each side of the step: left out of the fit, the face's own points
inline constexpr double kMaxShift = 0.18;  ///< m: how far from u = 0 the step may be
inline constexpr int kShift = static_cast<int>(kMaxShift / kBin + 0.5);
inline constexpr std::size_t kPlaces = 16;  ///< at which the step may be: 2 kShift + 1, made even

/// m in u, of a place.
[[nodiscard]] constexpr double step_place(std::size_t k) {
  return (static_cast<int>(k) - kShift) * kBin;
}

/// A figure of each place: those of all places are computed side by side.
using Places = std::array<double, kPlaces>;

/// Moments of one side, for each place of the step; where there is no side they mean nothing.
struct SideSums {
  Places n, u, t, z, uu, ut, tt, uz, tz, zz;
};

/// Places are computed by fours.
inline constexpr std::size_t kFours = kPlaces / 4;
/// A register's worth of Places, wherever it lies.
using FourPlaces = double __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));

/// Both sides at each place, and whether there are any. Of fours of which none has two sides nothing else is known.
struct Sides {
  std::array<bool, kPlaces> exist{};
  std::array<bool, kFours> any{};  ///< of the four places
  SideSums low;
  SideSums high;
};

/// Fills `sides` with the sums over the points of a window on both sides of each place. False if there are two sides at
/// no place: counting shows that, and is cheap.
[[nodiscard]] bool measure_sides(const StepWindow& points, const tile::CurbParameters& parameters, Sides& sides);

}  // namespace curbstone::semantic_map::curbs
