#include "tools/bench/mapping/methods/loam_cloud.hpp"

#include <utility>

#include "services/mapper/registration/ring_features.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::bench::mapping::methods {
namespace {

constexpr double kMaxCoordinate = 50'000;  // m; bound of the lattice

}  // namespace

LoamCloud::LoamCloud(const VehicleConfig& vehicle, const mapper::config::LoamConfig& config)
    : T_base_lidar_(vehicle.T_base_lidar()), config_(config) {}

void LoamCloud::add(const mapper::scan::Scan& scan, const evaluate::truth::StampedPose& pose) {
  const std::optional<evaluate::truth::StampedPose> before = std::exchange(last_, pose);
  if (!before || pose.utime <= before->utime) return;
  const double dt = static_cast<double>(pose.utime - before->utime) * 1e-6;
  const mapper::scan::Twist twist = mapper::scan::twist_of(before->pose.inverse() * pose.pose, dt);
  const double sweep = static_cast<double>(scan.end - scan.start) * 1e-6;
  const std::vector<mapper::scan::LidarPoint> points =
      mapper::scan::deskew(scan.points, T_base_lidar_, mapper::scan::steady_sweep(twist, sweep));
  const mapper::registration::RingFeatures features =
      mapper::registration::ring_features(points, T_base_lidar_.translation().cast<float>(), config_);
  take(features.edges, pose.pose, kEdgeVoxel, edges_);
  take(features.smooth, pose.pose, kPlaneVoxel, planes_);
}

void LoamCloud::take(const std::vector<mapper::scan::LidarPoint>& features, const Pose& T_map_base, double voxel,
                     mapper::voxels::FlatIndex& known) {
  for (const mapper::scan::LidarPoint& feature : features) {
    if (double{feature.position.norm()} > config_.max_range) continue;
    const Eigen::Vector3d p = T_map_base * feature.position.cast<double>();
    if (!(p.cwiseAbs().maxCoeff() < kMaxCoordinate)) continue;
    if (known.find_or_insert(mapper::voxels::voxel_key(mapper::voxels::voxel_of(p, 1 / voxel)), 0) !=
        mapper::voxels::FlatIndex::kNone)
      continue;
    cloud_.points.push_back({p.cast<float>(), static_cast<float>(feature.intensity)});
  }
}

}  // namespace curbstone::bench::mapping::methods
