#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/marking_lines/marking_field.hpp"

namespace curbstone::semantic_map::marking_lines {

/// A place on the middle of a marking.
struct RidgePoint {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();        ///< m in map
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();  ///< unit, along the marking; in a chain, the way that it goes
  double z = 0;
  double mass = 0;  ///< of the vote
  double contrast = 0;
  double width = 0;  ///< m, of the paint about it
};
using MarkingChain = std::vector<RidgePoint>;

struct ChainOptions {
  bool vote = true;  ///< off: no cell needs company (ablation)
};

/// Strong cells that the vote finds on a line, moved onto its middle, thinned to one each decimetre and linked from one
/// to the next along it, cut where the line turns a corner and where its width changes: the uninterrupted pieces of
/// paint. The same cells in the same order give the same chains.
[[nodiscard]] std::vector<MarkingChain> chain_markings(const MarkingField& field, const ChainOptions& options);

}  // namespace curbstone::semantic_map::marking_lines
