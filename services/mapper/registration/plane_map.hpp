#pragma once

#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/registration/shape_map.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::registration {

/// Planes of the world at two scales: fine ones where points are dense, coarse ones where they are sparse. Pure; one
/// thread.
class PlaneMap {
 public:
  struct Options {
    double fine_voxel = 0.3;    ///< m
    double coarse_voxel = 1.0;  ///< m
    double min_grazing = 0.05;  ///< as of ShapeLevelOptions
  };

  explicit PlaneMap(const Options& options);

  /// Where a point (map, m) is in the fine level: see ShapeLevel::place_of().
  [[nodiscard]] ShapeLevel::Place place_of(const Eigen::Vector3d& point) const { return fine_.place_of(point); }
  /// The finest plane within reach of the point (map, m); where none is, one that is out of reach; nullptr if there is
  /// none. The pointer lives until the next insert().
  [[nodiscard]] const MapShape* plane_at(const Eigen::Vector3d& point, const ShapeLevel::Place& place, double reach);
  [[nodiscard]] const MapShape* plane_at(const Eigen::Vector3d& point, double reach) {
    return plane_at(point, place_of(point), reach);
  }
  /// Adds the points of a scan, in base_link, seen by the lidar (there too).
  void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, const Eigen::Vector3f& lidar);
  /// Forgets what is farther than `radius` (in any axis) from `centre`.
  void keep_around(const Eigen::Vector3d& centre, double radius);
  [[nodiscard]] std::size_t size() const { return fine_.size() + coarse_.size(); }  ///< voxels

 private:
  ShapeLevel fine_;
  ShapeLevel coarse_;
};

}  // namespace curbstone::mapper::registration
