#include "services/mapper/registration/loam_registration.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"

namespace curbstone::mapper::registration {
namespace {

/// Neighbouring features share a shape and its error: one in 10 counts as independent.
constexpr double kFeatureIndependence = 1.0 / 10;
constexpr double kSettled = 0.15;  // m: reach below which the matches hardly change any more

}  // namespace

LoamRegistration::LoamRegistration(const config::LoamConfig& config, const Eigen::Vector3d& lidar)
    : config_(config),
      lidar_(lidar.cast<float>()),
      planes_({config.fine_voxel, config.coarse_voxel, config.min_grazing}),
      edges_({.shape = ShapeKind::kLine, .voxel = config.edge_voxel, .min_width = 0.4 * config.edge_voxel}) {}

void LoamRegistration::add_match(const scan::LidarPoint& feature, const MapShape& shape, bool line, const Pose& T,
                                 double reach, Matching& out) const {
  NormalEquations& sum = out.sum;
  ++sum.found;
  const Eigen::Vector3d p = feature.position.cast<double>();
  const Eigen::Vector3d axis = shape.axis.cast<double>();
  const Eigen::Vector3d off = T * p - shape.mean;
  const Eigen::Vector3d across = line ? Eigen::Vector3d(off - axis.dot(off) * axis) : Eigen::Vector3d(axis);
  const double distance = line ? across.norm() : std::abs(axis.dot(off));
  if (!(distance < reach)) return;
  const double sigma = std::sqrt(config_.sensor_sigma * config_.sensor_sigma + static_cast<double>(shape.variance));
  if (distance < 3 * config_.kernel * sigma) {
    ++sum.inliers;
    sum.squared_error += distance * distance;
  }
  const double w = (distance < config_.kernel * sigma ? 1.0 : config_.kernel * sigma / distance) / (sigma * sigma);
  if (line) {
    const Eigen::Vector3d u = axis.unitOrthogonal();
    for (const Eigen::Vector3d& n : {u, Eigen::Vector3d(axis.cross(u))}) {
      sum.add(p, T.linear().transpose() * n, n.dot(off), w);
    }
  } else {
    sum.add(p, T.linear().transpose() * axis, axis.dot(off), w);
  }
  out.matches.push_back({p, shape.mean, axis, 1 / sigma, line});
}

LoamRegistration::Matching LoamRegistration::match(const RingFeatures& features, const Pose& T, double reach) {
  Matching out;
  out.matches.reserve(features.planes.size() + features.edges.size());
  for (const scan::LidarPoint& feature : features.planes) {
    const MapShape* plane = planes_.plane_at(T * feature.position.cast<double>(), reach);
    if (plane != nullptr) add_match(feature, *plane, false, T, reach, out);
  }
  for (const scan::LidarPoint& feature : features.edges) {
    const MapShape* edge = edges_.shape_at(T * feature.position.cast<double>());
    if (edge != nullptr) add_match(feature, *edge, true, T, reach, out);
  }
  return out;
}

RegistrationResult LoamRegistration::align(const std::vector<scan::LidarPoint>& points, const PosePrior& prior) {
  const RingFeatures features = ring_features(points, lidar_, config_);
  RegistrationResult result;
  LoamProblem problem;
  problem.T_map_base = prior.T_map_base;
  problem.prior = prior;
  problem.prior_weight = 1 / kFeatureIndependence;
  Matching matching;
  double annealing = std::clamp(prior.reach, kSettled, std::max(config_.search, kSettled));
  while (result.iterations < config_.max_rounds && !result.converged) {
    ++result.iterations;
    matching = match(features, problem.T_map_base, std::max(annealing, 1.2 * kSettled));
    const Observability seen = observability(matching.sum, config_.degenerate_below);
    problem.matches = std::move(matching.matches);
    problem.seen = seen.P;
    problem.kernel = std::max(config_.kernel, 0.2 * annealing / config_.sensor_sigma);
    const Vector6 step = solve_loam(problem);
    if (!step.allFinite()) break;
    problem.T_map_base = normalised(problem.T_map_base * exp_of(step));
    result.degenerate = seen.degenerate;
    const bool settled = annealing <= kSettled && step.head<3>().norm() < 1e-3 && step.tail<3>().norm() < 2e-4;
    result.converged = settled;
    annealing = std::clamp(2 * step.head<3>().norm(), 0.5 * annealing, annealing);
    if (settled || result.iterations == config_.max_rounds) {
      const Matrix6 H = kFeatureIndependence * seen.P * matching.sum.H * seen.P.transpose() + prior.information;
      result.covariance = Ldlt<6>(H).inverse();
    }
  }
  const NormalEquations& sum = matching.sum;
  const std::size_t all = features.planes.size() + features.edges.size();
  result.T_map_base = problem.T_map_base;
  result.overlap = static_cast<double>(sum.found) / static_cast<double>(std::max<std::size_t>(all, 1));
  result.inlier_ratio = static_cast<double>(sum.inliers) / std::max(sum.found, 1);
  result.residual = sum.inliers > 0 ? std::sqrt(sum.squared_error / sum.inliers) : 0;
  return result;
}

void LoamRegistration::insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) {
  const RingFeatures features = ring_features(points, lidar_, config_);
  planes_.insert(features.smooth, T_map_base, lidar_);
  const Eigen::Matrix3f R = T_map_base.linear().cast<float>();
  for (const scan::LidarPoint& edge : features.edges) {
    edges_.insert(T_map_base * edge.position.cast<double>(), R * (edge.position - lidar_).normalized());
  }
  edges_.end_insertion();
}

/// As planes only: a downsampled scan has no rings from which edges could be extracted.
void LoamRegistration::insert_keyframe(const scan::Keyframe& node) {
  planes_.insert(scan::unpack(*node.points.read()), node.T_map_base, lidar_);
}

bool LoamRegistration::keep_around(const Eigen::Vector3d& centre) {
  if ((centre - kept_around_).norm() < 0.25 * config_.window) return false;
  kept_around_ = centre;
  planes_.keep_around(centre, config_.window);
  edges_.keep_around(centre, config_.window);
  return true;
}

}  // namespace curbstone::mapper::registration
