#pragma once

#include <Eigen/Core>
#include <vector>

namespace curbstone::semantic_map::curb_lines {

/// A curb point in the map frame.
struct MapCurbPoint {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();  ///< m
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();   ///< unit, towards the higher side
  double z = 0;                                    ///< m, of the low side at the foot
  double height = 0;                               ///< m, of the step
  double confidence = 0;                           ///< 0..1
  bool weak = false;                               ///< lower than a curb must be to count on its own
  double reach = 0;                                ///< m along the curb, on each side, from which the evidence comes
};

/// Indices of consecutive points of one curb, its higher side on the right.
using CurbChain = std::vector<std::size_t>;

/// Links neighbouring points along the curb: always up to 0.8 m, and beyond as far as the evidence of both reaches.
/// Then joins chains across gaps of up to 2.5 m, if each chain is longer than the gap, they have the same height, and
/// each points at the other's end. The same points in the same order give the same chains.
[[nodiscard]] std::vector<CurbChain> chain_curbs(const std::vector<MapCurbPoint>& points);

}  // namespace curbstone::semantic_map::curb_lines
