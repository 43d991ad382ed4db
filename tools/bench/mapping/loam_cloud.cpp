#include "tools/bench/mapping/loam_cloud.hpp"

#include <utility>

#include "services/mapper/deskew.hpp"
#include "services/mapper/ring_features.hpp"

namespace curbstone {
namespace {

constexpr double kFarthest = 50'000;  // m: the lattice has an end

}  // namespace

LoamCloud::LoamCloud(const VehicleConfig& vehicle, const LoamConfig& config)
    : T_base_lidar_(vehicle.T_base_lidar()), config_(config) {}

void LoamCloud::add(const Revolution& revolution, const StampedPose& pose) {
  const std::optional<StampedPose> before = std::exchange(last_, pose);
  if (!before || pose.utime <= before->utime) return;
  const double dt = static_cast<double>(pose.utime - before->utime) * 1e-6;
  const Twist twist = twist_of(before->pose.inverse() * pose.pose, dt);
  const double sweep = static_cast<double>(revolution.end - revolution.start) * 1e-6;
  const std::vector<LidarPoint> points = deskew(revolution.points, T_base_lidar_, steady_sweep(twist, sweep));
  const RingFeatures features = ring_features(points, T_base_lidar_.translation().cast<float>(), config_);
  take(features.edges, pose.pose, kEdgeVoxel, edges_);
  take(features.smooth, pose.pose, kPlaneVoxel, planes_);
}

void LoamCloud::take(const std::vector<LidarPoint>& features, const Pose& T_map_base, double voxel, FlatIndex& known) {
  for (const LidarPoint& feature : features) {
    if (double{feature.position.norm()} > config_.max_range) continue;
    const Eigen::Vector3d p = T_map_base * feature.position.cast<double>();
    if (!(p.cwiseAbs().maxCoeff() < kFarthest)) continue;
    if (known.find_or_insert(voxel_key(voxel_of(p, 1 / voxel)), 0) != FlatIndex::kNone) continue;
    cloud_.points.push_back({p.cast<float>(), static_cast<float>(feature.intensity)});
  }
}

}  // namespace curbstone
