#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/marking_lines/marking_field.hpp"

namespace curbstone::semantic_map::marking_lines {

/// What the cells of paint around say of a place in the plane.
struct PlaneVote {
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();  ///< unit, along the line; its sign says nothing
  double stick = 0;                                    ///< (l1 - l2) / l1: how much of a line
  double mass = 0;                                     ///< sum of the votes' weights
};

/// The paper's ball vote (eq. 1 to 6) in two dimensions: the vote of a cell at offset d, r = d / |d|, is
/// w exp(-|d|^2 / sigma^2) (I - r r^T), with the weight w by its contrast. The eigenvector of the larger eigenvalue is
/// the line's normal. Of strong cells, by them: index by index, and nothing at the others.
[[nodiscard]] std::vector<PlaneVote> vote_in_plane(const MarkingField& field, double sigma);

/// A cell's weight, 0..1: paint that is twice as bright as the road says no more than any paint.
[[nodiscard]] double weight_of(const MapMarkingCell& cell);

}  // namespace curbstone::semantic_map::marking_lines
