#pragma once

#include <vector>

#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::pose_graph {

/// What was measured between two nodes of the drive: odometry with registration from one to the next, or a loop.
struct PoseEdge {
  int from = 0;
  int to = 0;
  Pose T_from_to = Pose::Identity();
  registration::Matrix6 information =
      registration::Matrix6::Zero();  ///< inverse covariance of T_from_to, in the axes of `to`'s base_link
  bool closes_loop = false;           ///< found by recognising a place: may be false, so it may be outvoted
};

struct PoseGraphResult {
  std::vector<Pose> poses;         ///< T_map_base; those given where not `converged`
  bool converged = false;          ///< false also for input that cannot be solved
  double chi2_before = 0;          ///< sum over edges of squared Mahalanobis norms, those of loops through the kernel
  double chi2_after = 0;           ///< the same; not more, but for rounding
  std::vector<double> edge_sigma;  ///< Mahalanobis norm of each edge's residual after, without the kernel
  int iterations = 0;
};

/// Moves the nodes to where the edges are satisfied best: Levenberg-Marquardt over SE(3)^n with sparse Cholesky
/// (Grisetti, Kuemmerle, Stachniss, Burgard: A Tutorial on Graph-Based SLAM, 2010). Loops are held by the kernel of
/// Geman and McClure, whose width comes down from the largest residual of a loop: at first all pull alike, at last one
/// that contradicts the others hardly pulls (graduated non-convexity, after Yang, Antonante, Tzoumas, Carlone, RA-L
/// 2020).
///
/// Nodes that are `fixed`, or that no edge joins, keep their bits. Refused (not converged, the poses as given): sizes
/// that differ, an edge from or to no node or to itself, poses or information that are not finite or not positive
/// semi-definite, nodes that edges join to each other but not to a fixed one. Throws nothing. One thread; the same
/// input gives the same bits.
[[nodiscard]] PoseGraphResult optimise_pose_graph(const std::vector<Pose>& poses, const std::vector<bool>& fixed,
                                                  const std::vector<PoseEdge>& edges);

}  // namespace curbstone::mapper::pose_graph
