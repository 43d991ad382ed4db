#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "services/semantic_map/marking_lines/marking_field.hpp"

namespace curbstone::semantic_map::marking_lines {

/// The vote of the surrounding cells of paint for a place in the plane.
struct PlaneVote {
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();  ///< unit, along the line; its sign is arbitrary
  double stick = 0;                                    ///< (l1 - l2) / l1: line saliency
  double mass = 0;                                     ///< sum of the votes' weights
};

/// Computes the paper's ball vote (eq. 1 to 6) in two dimensions: the vote of a cell at offset d, r = d / |d|, is w
/// exp(-|d|^2 / sigma^2) (I - r r^T), with the weight w by its contrast. The eigenvector of the larger eigenvalue is
/// the line's normal. The strong cells around vote for the cell of this index.
[[nodiscard]] PlaneVote vote_in_plane(const MarkingField& field, std::size_t cell, double sigma);

/// Weight of a cell, 0..1: paint that is twice as bright as the road has no more weight than any paint.
[[nodiscard]] double weight_of(const MapMarkingCell& cell);

}  // namespace curbstone::semantic_map::marking_lines
