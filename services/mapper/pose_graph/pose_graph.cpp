#include "services/mapper/pose_graph/pose_graph.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>

#include "common/linear/decompositions.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

constexpr double kLoopKernel = 5.0;  // Mahalanobis: with six degrees of freedom, one correct edge in 3000 exceeds it
constexpr double kNarrowing = 4.0;   // factor from one solution to the next
constexpr int kIterations = 4;       // until the kernel is narrowed
constexpr int kLastIterations = 25;  // with the kernel at its last width
constexpr double kNothing = 1e-9;    // chi2: a smaller rest is rounding, which does not converge

/// The Geman-McClure kernel: beyond its width the influence of a residual decreases.
class GemanMcClure final : public ceres::LossFunction {
 public:
  explicit GemanMcClure(double width) : c2_(width * width) {}
  void Evaluate(double s, double* rho) const override {
    const double w = c2_ / (c2_ + s);
    rho[0] = w * s;
    rho[1] = w * w;
    rho[2] = -2 * w * w / (c2_ + s);
  }

 private:
  double c2_;
};

using Change = std::array<double, 6>;  // of a node: translation, then rotation vector, both in its axes as given

/// coefficients of 1, [v] and [v]^2 in the right Jacobian of SO(3): Exp(v + d) = Exp(v) Exp(J d)
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& v) {
  const double a2 = v.squaredNorm(), a = std::sqrt(a2);
  const double first = a < 1e-4 ? 0.5 - a2 / 24 : (1 - std::cos(a)) / a2;
  const double second = a < 1e-4 ? 1.0 / 6 - a2 / 120 : (a - std::sin(a)) / (a2 * a);
  const Eigen::Matrix3d m = skew(v);
  return Eigen::Matrix3d::Identity() - first * m + second * m * m;
}

Eigen::Matrix3d inverse_right_jacobian(const Eigen::Vector3d& v) {
  const double a2 = v.squaredNorm(), a = std::sqrt(a2);
  const double second = a < 1e-4 ? 1.0 / 12 + a2 / 720 : (1 - 0.5 * a / std::tan(0.5 * a)) / a2;
  const Eigen::Matrix3d m = skew(v);
  return Eigen::Matrix3d::Identity() + 0.5 * m + second * m * m;
}

Pose moved(const Pose& pose, const double* change) {
  const Eigen::Map<const Eigen::Vector3d> shift(change), turn(change + 3);
  Pose out = Pose::Identity();
  out.linear() = pose.linear() * so3_exp(turn).toRotationMatrix();
  out.translation() = pose.translation() + pose.linear() * shift;
  return out;
}

/// The residual of an edge, in sigmas. With E = T_from_to^-1 T_from^-1 T_to it is (translation of E, Log of its
/// rotation).
class EdgeDistance final : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  EdgeDistance(const PoseEdge& edge, const Pose& from, const Pose& to, const registration::Matrix6& root)
      : measured_(edge.T_from_to), from_(from), to_(to), root_(root) {}

  bool Evaluate(double const* const* changes, double* residual, double** jacobians) const override {
    const Pose from = moved(from_, changes[0]), to = moved(to_, changes[1]);
    const Pose between = from.inverse() * to;
    const Pose off = measured_.inverse() * between;
    registration::Vector6 r;
    r << off.translation(), so3_log(Eigen::Quaterniond(off.linear()));
    Eigen::Map<registration::Vector6>{residual} = root_ * r;
    if (!r.allFinite()) return false;
    if (jacobians == nullptr) return true;
    const Eigen::Matrix3d back = measured_.linear().transpose();
    const Eigen::Matrix3d turn = inverse_right_jacobian(r.tail<3>());
    if (jacobians[0] != nullptr) {
      registration::Matrix6 J = registration::Matrix6::Zero();
      J.topLeftCorner<3, 3>() = -back * from.linear().transpose() * from_.linear();
      J.topRightCorner<3, 3>() = back * skew(between.translation());
      J.bottomRightCorner<3, 3>() = -turn * between.linear().transpose();
      fill(J, changes[0], jacobians[0]);
    }
    if (jacobians[1] != nullptr) {
      registration::Matrix6 J = registration::Matrix6::Zero();
      J.topLeftCorner<3, 3>() = back * from.linear().transpose() * to_.linear();
      J.bottomRightCorner<3, 3>() = turn;
      fill(J, changes[1], jacobians[1]);
    }
    return true;
  }

 private:
  /// J is with respect to a rotation in the node's current axes; Ceres uses the total rotation vector.
  void fill(registration::Matrix6& J, const double* change, double* out) const {
    J.rightCols<3>() *= right_jacobian(Eigen::Map<const Eigen::Vector3d>(change + 3));
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{out} = root_ * J;
  }

  Pose measured_, from_, to_;
  registration::Matrix6 root_;
};

/// R with R^T R = information; nothing if the information is invalid.
std::optional<registration::Matrix6> root_of(const registration::Matrix6& information) {
  if (!information.allFinite()) return std::nullopt;
  const double size = information.cwiseAbs().maxCoeff();
  if ((information - information.transpose()).cwiseAbs().maxCoeff() > 1e-6 * size) return std::nullopt;
  if (const auto root = cholesky_root<6>(information)) return root;
  const auto [values, vectors] = eigen_pairs<6>(information);
  if (!(values[0] >= -1e-6 * size)) return std::nullopt;
  return values.cwiseMax(0).cwiseSqrt().asDiagonal() * vectors.transpose();
}

/// Whether every edge is connected, through others, to a fixed node.
bool all_hang(const std::vector<bool>& fixed, const std::vector<PoseEdge>& edges) {
  std::vector<std::size_t> group(fixed.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto head = [&](int node) {
    auto i = static_cast<std::size_t>(node);
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const PoseEdge& edge : edges) group[head(edge.from)] = head(edge.to);
  std::vector<bool> hangs(fixed.size(), false);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i]) hangs[head(static_cast<int>(i))] = true;
  }
  return std::all_of(edges.begin(), edges.end(), [&](const PoseEdge& edge) { return hangs[head(edge.to)]; });
}

/// The square roots of all edges' information; nothing if the graph is invalid.
std::optional<std::vector<registration::Matrix6>> checked(const std::vector<Pose>& poses,
                                                          const std::vector<bool>& fixed,
                                                          const std::vector<PoseEdge>& edges) {
  if (fixed.size() != poses.size() || !std::all_of(poses.begin(), poses.end(), is_finite)) return std::nullopt;
  const auto exists = [&](int node) { return node >= 0 && static_cast<std::size_t>(node) < poses.size(); };
  std::vector<registration::Matrix6> roots;
  for (const PoseEdge& edge : edges) {
    if (!exists(edge.from) || !exists(edge.to) || edge.from == edge.to || !is_finite(edge.T_from_to))
      return std::nullopt;
    const std::optional<registration::Matrix6> root = root_of(edge.information);
    if (!root) return std::nullopt;
    roots.push_back(*root);
  }
  if (!all_hang(fixed, edges)) return std::nullopt;
  return roots;
}

/// The graph as a Ceres problem.
class PoseGraphProblem {
 public:
  PoseGraphProblem(const std::vector<Pose>& poses, const std::vector<bool>& fixed, const std::vector<PoseEdge>& edges,
                   const std::vector<registration::Matrix6>& roots)
      : edges_(edges), changes_(poses.size(), Change{}), kernel_(nullptr, ceres::TAKE_OWNERSHIP), problem_(owner()) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto from = static_cast<std::size_t>(edges[i].from), to = static_cast<std::size_t>(edges[i].to);
      costs_.emplace_back(edges[i], poses[from], poses[to], roots[i]);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      double *from = change(edges[i].from), *to = change(edges[i].to);
      problem_.AddResidualBlock(&costs_[i], edges[i].closes_loop ? &kernel_ : nullptr, from, to);
      if (fixed[static_cast<std::size_t>(edges[i].from)]) problem_.SetParameterBlockConstant(from);
      if (fixed[static_cast<std::size_t>(edges[i].to)]) problem_.SetParameterBlockConstant(to);
    }
  }

  ceres::Solver::Summary solve(double kernel, int iterations) {
    kernel_.Reset(new GemanMcClure(kernel), ceres::TAKE_OWNERSHIP);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // no BLAS: its threads affect the last bits
    options.num_threads = 1;
    options.max_num_iterations = iterations;
    options.initial_trust_region_radius = 1e10;  // a long chain has modes of low curvature, which must not be damped
    options.max_trust_region_radius = 1e16;
    options.function_tolerance = 1e-7;
    options.parameter_tolerance = 1e-9;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary;
  }
  /// Mahalanobis norms at the nodes' current poses.
  [[nodiscard]] std::vector<double> sigmas() {
    std::vector<double> out;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const std::array<const double*, 2> changes{change(edges_[i].from), change(edges_[i].to)};
      registration::Vector6 r;
      costs_[i].Evaluate(changes.data(), r.data(), nullptr);
      out.push_back(r.norm());
    }
    return out;
  }
  [[nodiscard]] double* change(int node) { return changes_[static_cast<std::size_t>(node)].data(); }

 private:
  static ceres::Problem::Options owner() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  const std::vector<PoseEdge>& edges_;
  std::vector<Change> changes_;
  std::deque<EdgeDistance> costs_;  // Ceres requires stable addresses
  ceres::LossFunctionWrapper kernel_;
  ceres::Problem problem_;
};

double chi2(const std::vector<PoseEdge>& edges, const std::vector<double>& sigmas) {
  const GemanMcClure kernel(kLoopKernel);
  double sum = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    std::array<double, 3> rho{sigmas[i] * sigmas[i], 0, 0};
    if (edges[i].closes_loop) kernel.Evaluate(rho[0], rho.data());
    sum += rho[0];
  }
  return sum;
}

double largest_of_a_loop(const std::vector<PoseEdge>& edges, const std::vector<double>& sigmas) {
  double most = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].closes_loop) most = std::max(most, sigmas[i]);
  }
  return most;
}

}  // namespace

PoseGraphResult optimise_pose_graph(const std::vector<Pose>& poses, const std::vector<bool>& fixed,
                                    const std::vector<PoseEdge>& edges) {
  PoseGraphResult result;
  result.poses = poses;
  const std::optional<std::vector<registration::Matrix6>> roots = checked(poses, fixed, edges);
  if (!roots) return result;
  PoseGraphProblem graph(poses, fixed, edges, *roots);
  result.edge_sigma = graph.sigmas();
  result.chi2_before = result.chi2_after = chi2(edges, result.edge_sigma);
  if (!std::isfinite(result.chi2_before)) return result;

  for (double kernel = 2 * largest_of_a_loop(edges, result.edge_sigma); kernel > kLoopKernel; kernel /= kNarrowing) {
    result.iterations += static_cast<int>(graph.solve(kernel, kIterations).iterations.size());
  }
  const ceres::Solver::Summary summary = graph.solve(kLoopKernel, kLastIterations);
  result.iterations += static_cast<int>(summary.iterations.size());

  const std::vector<double> sigmas = graph.sigmas();
  const double after = chi2(edges, sigmas);
  const bool settled = summary.termination_type == ceres::CONVERGENCE || after < kNothing;
  result.converged = settled && after <= (1 + 1e-9) * result.chi2_before + kNothing;
  if (!result.converged) return result;
  result.edge_sigma = sigmas;
  result.chi2_after = after;
  std::vector<bool> joined(poses.size(), false);
  for (const PoseEdge& edge : edges) {
    joined[static_cast<std::size_t>(edge.from)] = joined[static_cast<std::size_t>(edge.to)] = true;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (joined[i] && !fixed[i]) result.poses[i] = normalised(moved(poses[i], graph.change(static_cast<int>(i))));
  }
  return result;
}

}  // namespace curbstone::mapper::pose_graph
