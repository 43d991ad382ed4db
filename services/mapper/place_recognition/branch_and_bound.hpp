#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "services/mapper/place_recognition/precomputation_grids.hpp"

namespace curbstone::mapper::place_recognition {

/// Search window about the origin of the frame: x and y within +-`reach`, yaw within +-`turn` of `yaw`.
struct SearchWindow {
  double reach = 5;   ///< m
  double yaw = 0;     ///< rad
  double turn = 0.2;  ///< rad
};

struct PlanarPose {
  double x = 0, y = 0, yaw = 0;  ///< m, rad
  double score = 0;              ///< 0..1: mean likelihood of the points at this pose
};

/// Finds the poses at which a scan's upright points best match the map's: the best pose, the best distinct from it, and
/// so on. Returns at most `most`, none with a score below 0.5 or more than 0.35 below the best. Branch and bound over
/// shifts, for each yaw (Hess et al., ICRA 2016, section V), best first, so the results are the true maxima on the
/// lattice of shifts. `points`: levelled, in base_link; points that the lattice might not cover at the rim of the
/// window are left out. Deterministic; bounded.
[[nodiscard]] std::vector<PlanarPose> branch_and_bound(const PrecomputationGrids& map,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const SearchWindow& range, int most);

/// The reach of the lattice that a search needs: m.
[[nodiscard]] double lattice_reach(double search_reach);

}  // namespace curbstone::mapper::place_recognition
