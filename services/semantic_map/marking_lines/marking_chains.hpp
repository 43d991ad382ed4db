#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/marking_lines/marking_field.hpp"

namespace curbstone::semantic_map::marking_lines {

/// A point on the centre line of a marking.
struct RidgePoint {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();        ///< m in map
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();  ///< unit, along the marking; in a chain, in its direction
  double z = 0;                                        ///< m in map
  double mass = 0;                                     ///< of the vote
  double contrast = 0;                                 ///< over the ground around, as in MarkingCell
  double width = 0;                                    ///< m, of the paint here
};
using MarkingChain = std::vector<RidgePoint>;

struct ChainOptions {
  bool vote = true;  ///< off: cells need no support by others (ablation)
};

/// Finds the uninterrupted pieces of paint: strong cells on a line by the vote are moved onto its centre, thinned to
/// one each decimetre, and linked along it; chains are cut at corners and where the width changes. The same cells in
/// the same order give the same chains.
[[nodiscard]] std::vector<MarkingChain> chain_markings(const MarkingField& field, const ChainOptions& options);

}  // namespace curbstone::semantic_map::marking_lines
