#include "services/mapper/registration/plane_map.hpp"

#include <cmath>

namespace curbstone::mapper::registration {

PlaneMap::PlaneMap(const Options& options)
    : fine_({.voxel = options.fine_voxel, .min_width = 0.4 * options.fine_voxel, .min_grazing = options.min_grazing}),
      coarse_({.voxel = options.coarse_voxel,
               .capacity = 100,
               .min_points = 10,
               .min_width = 0.3 * options.coarse_voxel,
               .min_grazing = options.min_grazing}) {}

const MapShape* PlaneMap::plane_at(const Eigen::Vector3d& point, const ShapeLevel::Place& place, double reach) {
  const MapShape* fine = fine_.shape_at(point, place);
  if (fine != nullptr && std::abs(fine->axis.cast<double>().dot(point - fine->mean)) < reach) return fine;
  const MapShape* coarse = coarse_.shape_at(point);
  return coarse != nullptr ? coarse : fine;
}

void PlaneMap::insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                      const Eigen::Vector3f& lidar) {
  const Eigen::Matrix3f R = T_map_base.linear().cast<float>();
  for (const scan::LidarPoint& point : points) {
    const Eigen::Vector3d p = T_map_base * point.position.cast<double>();
    const Eigen::Vector3f ray = R * (point.position - lidar).normalized();
    fine_.insert(p, ray);
    coarse_.insert(p, ray);
  }
  fine_.end_insertion();
  coarse_.end_insertion();
}

void PlaneMap::keep_around(const Eigen::Vector3d& centre, double radius) {
  fine_.keep_around(centre, radius);
  coarse_.keep_around(centre, radius);
}

}  // namespace curbstone::mapper::registration
