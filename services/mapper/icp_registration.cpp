#include "services/mapper/icp_registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "services/mapper/deskew.hpp"
#include "services/mapper/downsample.hpp"

namespace curbstone {
namespace {

/// Points near each other share their plane and its error: of so many, one counts.
constexpr double kIndependence = 1.0 / 25;

/// Sums of one Gauss-Newton step: H d = -b.
struct NormalEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  double weight = 0;         // sum of robust weights
  double lever = 0;          // sum of weight * squared distance of the point from base_link
  double squared_error = 0;  // of inliers, m^2
  int found = 0;             // points for which the map had a plane
  int inliers = 0;
};

/// The weights of one iteration.
struct Kernel {
  double reach;            // m, to a plane at most
  double bound;            // m, Huber
  double sensor_variance;  // m^2
};

void add_point(const Eigen::Vector3d& p, const MapPlane& plane, const Pose& T, const Kernel& kernel,
               NormalEquations& sum) {
  const Eigen::Vector3d n = plane.normal.cast<double>();
  const double r = n.dot(T * p - plane.mean.cast<double>());
  const double error = std::abs(r);
  ++sum.found;
  if (!(error < kernel.reach)) return;
  const double variance = kernel.sensor_variance + static_cast<double>(plane.variance);
  const double bound = std::max(kernel.bound, std::sqrt(variance));
  if (error < 3 * bound) {
    ++sum.inliers;
    sum.squared_error += r * r;
  }
  const double w = (error <= bound ? 1.0 : bound / error) / variance;
  // d r / d (translation, rotation) in base_link axes, for T <- T * exp(d)
  Vector6 J;
  J.head<3>() = T.linear().transpose() * n;
  J.tail<3>() = p.cross(J.head<3>());
  sum.H.noalias() += w * J * J.transpose();
  sum.b += w * r * J;
  sum.weight += w;
  sum.lever += w * p.squaredNorm();
}

Vector6 log_of(const Pose& T) {
  const Twist twist = twist_of(T, 1.0);
  Vector6 out;
  out << twist.linear, twist.angular;
  return out;
}

Pose exp_of(const Vector6& d) {
  return move({d.head<3>(), d.tail<3>()}, 1.0);
}

/// What the points say, with the directions taken out about which they say nothing.
struct Constraint {
  Matrix6 H;
  Vector6 b;
  int degenerate = 0;
};

/// H is made free of units (rotations by the mean lever arm, all by the sum of weights): an eigenvalue is then the mean
/// squared cosine between its direction and the constraints. Below `threshold` the direction is projected out.
Constraint without_degenerate(const NormalEquations& sum, double threshold) {
  Constraint out{sum.H, sum.b, 0};
  if (!(sum.weight > 0)) return {Matrix6::Zero(), Vector6::Zero(), 0x3f};
  const double lever = std::sqrt(std::max(sum.lever / sum.weight, 1e-6));
  Vector6 scale;
  scale << 1, 1, 1, 1 / lever, 1 / lever, 1 / lever;
  const Matrix6 D = scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(D * sum.H * D / sum.weight);
  if (solver.eigenvalues()[0] >= threshold) return out;
  Matrix6 keep = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6 v = solver.eigenvectors().col(i);
    if (solver.eigenvalues()[i] >= threshold) {
      keep += v * v.transpose();
      continue;
    }
    for (int axis = 0; axis < 6; ++axis) {
      if (std::abs(v[axis]) > 0.5) out.degenerate |= 1 << axis;
    }
  }
  const Matrix6 P = D.inverse() * keep * D;  // acts on H from both sides in its own units
  out.H = P * sum.H * P.transpose();
  out.b = P * sum.b;
  return out;
}

}  // namespace

IcpRegistration::IcpRegistration(const IcpConfig& config, const Eigen::Vector3d& lidar)
    : config_(config),
      lidar_(lidar.cast<float>()),
      fine_({.voxel = config.fine_voxel, .min_width = 0.4 * config.fine_voxel, .min_grazing = config.min_grazing}),
      coarse_({.voxel = config.coarse_voxel,
               .capacity = 100,
               .min_points = 10,
               .min_width = 0.3 * config.coarse_voxel,
               .min_grazing = config.min_grazing}) {}

/// The finest plane within reach; where none is, one that is out of reach.
const MapPlane* IcpRegistration::plane_at(const Eigen::Vector3f& point, float reach, Place& place) {
  const MapPlane* fine = fine_.plane_at(point, place.fine);
  if (fine != nullptr && std::abs(fine->normal.dot(point - fine->mean)) < reach) return fine;
  const MapPlane* coarse = coarse_.plane_at(point, place.coarse);
  return coarse != nullptr ? coarse : fine;
}

RegistrationResult IcpRegistration::align(const std::vector<LidarPoint>& points, const PosePrior& prior) {
  const std::vector<LidarPoint> source = downsample(points, config_.source_voxel, config_.max_range);
  RegistrationResult result;
  Pose T = prior.T_map_base;
  NormalEquations sum;
  double annealing = std::clamp(prior.reach, 5 * config_.kernel, std::max(config_.search, 5 * config_.kernel));
  places_.assign(source.size(), {});
  while (result.iterations < config_.max_iterations && !result.converged) {
    ++result.iterations;
    const Kernel kernel{std::max(annealing, 6 * config_.kernel), std::max(0.2 * annealing, config_.kernel),
                        config_.sensor_sigma * config_.sensor_sigma};
    sum = {};
    for (std::size_t i = 0; i < source.size(); ++i) {
      const Eigen::Vector3d p = source[i].position.cast<double>();
      const MapPlane* plane = plane_at((T * p).cast<float>(), static_cast<float>(kernel.reach), places_[i]);
      if (plane != nullptr) add_point(p, *plane, T, kernel, sum);
    }
    const Constraint lidar = without_degenerate(sum, config_.degenerate_below);
    const Matrix6 H = kIndependence * lidar.H + prior.information;
    const Vector6 b = kIndependence * lidar.b + prior.information * log_of(prior.T_map_base.inverse() * T);
    const Vector6 step = H.ldlt().solve(-b);
    if (!step.allFinite()) break;
    T = normalised(T * exp_of(step));
    result.degenerate = lidar.degenerate;
    const bool annealed = annealing <= 5 * config_.kernel;
    result.converged = annealed && step.head<3>().norm() < 5e-4 && step.tail<3>().norm() < 1e-4;
    annealing = std::clamp(2 * step.head<3>().norm(), 0.5 * annealing, annealing);
    if (result.converged || result.iterations == config_.max_iterations) {
      result.covariance = H.ldlt().solve(Matrix6::Identity());
    }
  }
  result.T_map_base = T;
  result.overlap = static_cast<double>(sum.found) / static_cast<double>(std::max<std::size_t>(source.size(), 1));
  result.inlier_ratio = static_cast<double>(sum.inliers) / std::max(sum.found, 1);
  result.residual = sum.inliers > 0 ? std::sqrt(sum.squared_error / sum.inliers) : 0;
  return result;
}

void IcpRegistration::insert(const std::vector<LidarPoint>& points, const Pose& T_map_base) {
  const Eigen::Isometry3f T = T_map_base.cast<float>();
  for (const LidarPoint& point : downsample(points, config_.source_voxel, config_.max_range)) {
    const Eigen::Vector3f p = T * point.position;
    const Eigen::Vector3f ray = T.linear() * (point.position - lidar_).normalized();
    fine_.insert(p, ray);
    coarse_.insert(p, ray);
  }
  fine_.end_insertion();
  coarse_.end_insertion();
}

void IcpRegistration::keep_around(const Eigen::Vector3d& centre) {
  if ((centre - kept_around_).norm() < 0.25 * config_.window) return;
  kept_around_ = centre;
  fine_.keep_around(centre.cast<float>(), static_cast<float>(config_.window));
  coarse_.keep_around(centre.cast<float>(), static_cast<float>(config_.window));
}

}  // namespace curbstone
