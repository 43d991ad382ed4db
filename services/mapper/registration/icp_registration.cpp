#include "services/mapper/registration/icp_registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/linear/decompositions.hpp"
#include "services/mapper/registration/normal_equations.hpp"
#include "services/mapper/scan/downsample.hpp"

namespace curbstone::mapper::registration {
namespace {

/// Neighbouring points share a plane and its error: one in 25 counts as independent.
constexpr double kIndependence = 1.0 / 25;

constexpr std::size_t kCoarseStride = 4;  // one point in four is used until the pose has settled, then all are
constexpr double kRematch = 0.01;         // m: correspondences are searched again once the pose has moved this far,
constexpr double kRematchTurn = 0.001;    // rad: or turned this far
constexpr double kSettledBounds = 5;      // of the kernel's bound: once steps are smaller, all points are used
constexpr double kLastStep = 5e-4;        // m: the iteration ends with a step below this
constexpr double kLastTurn = 1e-4;        // and below this, in rad

/// The equations of a step d, H d = -b: the matches, without the directions that they do not constrain, and the prior.
struct StepEquations {
  Ldlt<6> H;
  Vector6 b;

  /// `off_prior`: the pose relative to the prior's.
  StepEquations(const NormalEquations& sum, const Matrix6& P, const PosePrior& prior, const Pose& off_prior)
      : H(kIndependence * P * sum.H * P.transpose() + prior.information),
        b(kIndependence * P * sum.b + prior.information * log_of(off_prior)) {}
};

/// Fills in overlap, inliers and residual of the result, from the matches of the last step of `sought` points.
void describe(const NormalEquations& sum, double sought, RegistrationResult& result) {
  result.overlap = sum.found / std::max(sought, 1.0);
  result.inlier_ratio = static_cast<double>(sum.inliers) / std::max(sum.found, 1);
  result.residual = sum.inliers > 0 ? std::sqrt(sum.squared_error / sum.inliers) : 0;
}

}  // namespace

IcpRegistration::IcpRegistration(const config::IcpConfig& config, const Eigen::Vector3d& lidar)
    : config_(config),
      lidar_(lidar.cast<float>()),
      map_({config.fine_voxel, config.coarse_voxel, config.min_grazing}) {}

void IcpRegistration::match(const std::vector<scan::LidarPoint>& source, std::size_t stride, const Pose& T_map_base,
                            double reach) {
  matches_.clear();
  const Eigen::Matrix3d R = T_map_base.linear();
  const double sensor_variance = config_.sensor_sigma * config_.sensor_sigma;
  std::array<Eigen::Vector3d, ShapeLevel::kTogether> in_map;
  std::array<const MapShape*, ShapeLevel::kTogether> planes;
  for (std::size_t begin = 0; begin < source.size(); begin += ShapeLevel::kTogether * stride) {
    const std::size_t size = std::min(ShapeLevel::kTogether, (source.size() - begin + stride - 1) / stride);
    for (std::size_t k = 0; k < size; ++k) in_map[k] = T_map_base * source[begin + k * stride].position.cast<double>();
    map_.planes_at({in_map.data(), size}, reach, {planes.data(), size});
    for (std::size_t k = 0; k < size; ++k) {
      if (planes[k] == nullptr) continue;
      const Eigen::Vector3d n = planes[k]->axis.cast<double>();
      matches_.add(source[begin + k * stride].position, (R.transpose() * n).cast<float>(),
                   n.dot(in_map[k] - planes[k]->mean), sensor_variance + static_cast<double>(planes[k]->variance));
    }
  }
}

/// Alternates matching and Gauss-Newton steps until the steps are small: first with a subset of the points and a wide
/// kernel, then with all points and a narrow one.
RegistrationResult IcpRegistration::align(const std::vector<scan::LidarPoint>& points, const PosePrior& prior) {
  const std::vector<scan::LidarPoint> source = scan::downsample(points, config_.source_voxel, config_.max_range);
  const double settled = kSettledBounds * config_.kernel;
  double annealing = std::clamp(prior.reach, settled, std::max(config_.search, settled));  // m, expected error
  Pose T_matched = prior.T_map_base;                                                       // where points were matched
  Pose moved = Pose::Identity();                                                           // since then
  std::size_t stride = kCoarseStride;
  bool stale = true;
  RegistrationResult result;
  NormalEquations sum;
  while (result.iterations < config_.max_iterations && !result.converged) {
    ++result.iterations;
    const RobustKernel kernel{std::max(annealing, 6 * config_.kernel), std::max(0.2 * annealing, config_.kernel)};
    if (stale) {
      T_matched = normalised(T_matched * moved);
      moved = Pose::Identity();
      match(source, stride, T_matched, kernel.reach);
    }
    sum = matches_.at(moved, kernel);
    const Observability seen = observability(sum, config_.degenerate_below);
    const StepEquations equations(sum, seen.P, prior, prior.T_map_base.inverse() * T_matched * moved);
    const Vector6 step = equations.H.solve(-equations.b);
    if (!step.allFinite()) break;
    moved = moved * exp_of(step);
    result.degenerate = seen.degenerate;
    result.converged = stride == 1 && step.head<3>().norm() < kLastStep && step.tail<3>().norm() < kLastTurn;
    if (result.converged || result.iterations == config_.max_iterations) result.covariance = equations.H.inverse();

    annealing = std::clamp(2 * step.head<3>().norm(), 0.5 * annealing, annealing);
    const Vector6 since = log_of(moved);
    stale = since.head<3>().norm() > kRematch || since.tail<3>().norm() > kRematchTurn;
    const bool goes_on = !result.converged && result.iterations < config_.max_iterations;
    if (goes_on && stride > 1 && annealing <= settled) {
      stride = 1;
      stale = true;
    }
  }
  result.T_map_base = normalised(T_matched * moved);
  const std::size_t sought = (source.size() + stride - 1) / stride;
  describe(sum, static_cast<double>(sought), result);
  return result;
}

void IcpRegistration::insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) {
  map_.insert(scan::downsample(points, config_.source_voxel, config_.max_range), T_map_base, lidar_);
}

void IcpRegistration::insert_keyframe(const scan::Keyframe& node) {
  map_.insert(scan::unpack(*node.points.read()), node.T_map_base, lidar_);
}

bool IcpRegistration::keep_around(const Eigen::Vector3d& centre) {
  if ((centre - kept_around_).norm() < 0.25 * config_.window) return false;
  kept_around_ = centre;
  map_.keep_around(centre, config_.window);
  return true;
}

}  // namespace curbstone::mapper::registration
