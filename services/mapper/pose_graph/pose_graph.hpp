#pragma once

#include <vector>

#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::pose_graph {

/// A measurement between two nodes: registration and odometry from one to the next, or a loop closure.
struct PoseEdge {
  int from = 0;
  int to = 0;
  Pose T_from_to = Pose::Identity();
  registration::Matrix6 information =
      registration::Matrix6::Zero();  ///< inverse covariance of T_from_to, in the axes of `to`'s base_link
  bool closes_loop = false;           ///< from place recognition: may be false, so it can be rejected as an outlier
};

struct PoseGraphResult {
  std::vector<Pose> poses;         ///< T_map_base; the input's if not `converged`
  bool converged = false;          ///< false also for invalid input
  double chi2_before = 0;          ///< sum over edges of squared Mahalanobis norms, with the kernel for loops
  double chi2_after = 0;           ///< the same; not larger, but for rounding
  std::vector<double> edge_sigma;  ///< Mahalanobis norm of each edge's residual after optimisation, without the kernel
  int iterations = 0;
};

/// Optimises a pose graph: Levenberg-Marquardt over SE(3)^n with sparse Cholesky (Grisetti, Kuemmerle, Stachniss,
/// Burgard: A Tutorial on Graph-Based SLAM, 2010). Loops have a Geman-McClure kernel, whose width shrinks from the
/// largest residual of a loop: at first all loops have similar weights, in the end one that contradicts the others has
/// hardly any (graduated non-convexity, after Yang, Antonante, Tzoumas, Carlone, RA-L 2020).
///
/// Nodes that are `fixed`, or that have no edge, are returned bit-identical. Invalid input is returned unchanged, not
/// converged: sizes that differ; an edge with an unknown node or from a node to itself; poses or information that are
/// not finite, or information that is not positive semi-definite; nodes that are connected to each other but not to a
/// fixed one. Never throws. One thread; the same input gives the same bits.
[[nodiscard]] PoseGraphResult optimise_pose_graph(const std::vector<Pose>& poses, const std::vector<bool>& fixed,
                                                  const std::vector<PoseEdge>& edges);

}  // namespace curbstone::mapper::pose_graph
