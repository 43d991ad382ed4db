#pragma once

#include <cstdint>

#include "tools/bench/curbs/scenes/voted_log.hpp"
#include "tools/bench/markings/marking_score.hpp"
#include "tools/simulate/paint/painted_ground.hpp"

namespace curbstone::bench::markings {

/// A drive through an emulated town, up to the vote, and the true paint.
struct PaintedTown {
  curbs::scenes::DriveTiles made;
  evaluate::truth::Trajectory poses;  ///< true, T_world_base
  std::vector<TrueLine> lines;
};

[[nodiscard]] PaintedTown drive_painted_town(std::uint64_t seed, double seconds, simulate::paint::Paint paint,
                                             bool ring_gains);

}  // namespace curbstone::bench::markings
