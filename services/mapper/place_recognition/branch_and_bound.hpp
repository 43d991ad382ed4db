#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "services/mapper/place_recognition/precomputation_grids.hpp"

namespace curbstone::mapper::place_recognition {

/// Where to look, about the origin of the frame: x and y within +-`reach`, yaw within +-`turn` of `yaw`.
struct SearchWindow {
  double reach = 5;   ///< m
  double yaw = 0;     ///< rad
  double turn = 0.2;  ///< rad
};

struct PlanarPose {
  double x = 0, y = 0, yaw = 0;  ///< m, rad
  double score = 0;              ///< 0..1: mean likelihood of the points there
};

/// The poses from which a scan's upright points fall best on the map's: the best, the best that is another, and so on,
/// at most `most`, none that scores less than 0.5 or 0.35 less than the best. Branch and bound over shifts for each of
/// the turns (Hess et al., ICRA 2016, section V), best first, so they are the true maxima of the lattice of shifts.
/// `points`: levelled, in base_link; those that the lattice might not hold at the end of the range are left out.
/// Deterministic; bounded.
[[nodiscard]] std::vector<PlanarPose> branch_and_bound(const PrecomputationGrids& map,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const SearchWindow& range, int most);

/// How far the lattice must reach for a search: m.
[[nodiscard]] double lattice_reach(double search_reach);

}  // namespace curbstone::mapper::place_recognition
