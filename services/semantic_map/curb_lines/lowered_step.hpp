#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// Height of the ground that was seen at a place, m in map; nothing if none was seen.
using SeenGround = std::function<std::optional<double>(const Eigen::Vector2d& at)>;

/// A low step along a whole line.
struct LoweredStep {
  double height = 0;  ///< m
  double sigma = 0;   ///< m, 1 sigma of the height
};

/// Whether the ground steps up along a line whose place is known, by all that was seen on both sides of it: least
/// squares of
///
///   z = c_0 + c_1 t + c_2 t^2 + b_low u [u < 0] + b_high u [u > 0] + h [u > 0]
///
/// over the ground 0.14 to 0.50 m off the line (u across it, towards the higher side, t along it). Each side has its
/// own slope: a road falls towards a lowered kerb, and a ramp rises behind it. Nothing where less than three fifths of
/// the line were seen on both sides, or where either half of it does not step up by half as much as the whole.
[[nodiscard]] std::optional<LoweredStep> find_lowered_step(const SeenGround& ground,
                                                           const std::vector<tile::CurbVertex>& line);

}  // namespace curbstone::semantic_map::curb_lines
