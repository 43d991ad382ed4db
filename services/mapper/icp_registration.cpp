#include "services/mapper/icp_registration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "services/mapper/downsample.hpp"
#include "services/mapper/normal_equations.hpp"

namespace curbstone {
namespace {

/// Points near each other share their plane and its error: of so many, one counts.
constexpr double kIndependence = 1.0 / 25;

/// The weights of one iteration.
struct Kernel {
  double reach;            // m, to a plane at most
  double bound;            // m, Huber
  double sensor_variance;  // m^2
};

void add_point(const Eigen::Vector3d& p, const MapShape& plane, const Pose& T, const Kernel& kernel,
               NormalEquations& sum) {
  const Eigen::Vector3d n = plane.axis.cast<double>();
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
  sum.add(p, T.linear().transpose() * n, r, (error <= bound ? 1.0 : bound / error) / variance);
}

}  // namespace

IcpRegistration::IcpRegistration(const IcpConfig& config, const Eigen::Vector3d& lidar)
    : config_(config),
      lidar_(lidar.cast<float>()),
      map_({config.fine_voxel, config.coarse_voxel, config.min_grazing}) {}

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
      const MapShape* plane = map_.plane_at((T * p).cast<float>(), static_cast<float>(kernel.reach), places_[i]);
      if (plane != nullptr) add_point(p, *plane, T, kernel, sum);
    }
    const Observability seen = observability(sum, config_.degenerate_below);
    const Matrix6 H = kIndependence * seen.P * sum.H * seen.P.transpose() + prior.information;
    const Vector6 b = kIndependence * seen.P * sum.b + prior.information * log_of(prior.T_map_base.inverse() * T);
    const Vector6 step = H.ldlt().solve(-b);
    if (!step.allFinite()) break;
    T = normalised(T * exp_of(step));
    result.degenerate = seen.degenerate;
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
  map_.insert(downsample(points, config_.source_voxel, config_.max_range), T_map_base, lidar_);
}

void IcpRegistration::recall(const MapNode& node) {
  map_.insert(unpack(node.points), node.T_map_base, lidar_);
}

bool IcpRegistration::keep_around(const Eigen::Vector3d& centre) {
  if ((centre - kept_around_).norm() < 0.25 * config_.window) return false;
  kept_around_ = centre;
  map_.keep_around(centre.cast<float>(), static_cast<float>(config_.window));
  return true;
}

}  // namespace curbstone
