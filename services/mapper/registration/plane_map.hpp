#pragma once

#include <span>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/registration/shape_map.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::registration {

/// Map of planes at two scales: fine ones where points are dense, coarse ones where they are sparse. Pure; one thread.
class PlaneMap {
 public:
  struct Options {
    double fine_voxel = 0.3;    ///< m
    double coarse_voxel = 1.0;  ///< m
    double min_grazing = 0.05;  ///< as in ShapeLevelOptions
  };

  explicit PlaneMap(const Options& options);

  /// The finest plane within reach of each point (map, m). If no plane is within reach, one that is out of reach;
  /// nullptr if there is none at all. The pointers are valid until the next insert().
  void planes_at(std::span<const Eigen::Vector3d> points, double reach, std::span<const MapShape*> planes);
  [[nodiscard]] const MapShape* plane_at(const Eigen::Vector3d& point, double reach);
  /// Adds the points of a scan. `points` and the position `lidar` are in base_link, m.
  void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, const Eigen::Vector3f& lidar);
  /// Drops everything farther than `radius` m (in any axis) from `centre`.
  void keep_around(const Eigen::Vector3d& centre, double radius);
  [[nodiscard]] std::vector<ShapeLevel*> levels() { return {&fine_, &coarse_}; }
  [[nodiscard]] std::size_t size() const { return fine_.size() + coarse_.size(); }  ///< voxels

 private:
  ShapeLevel fine_;
  ShapeLevel coarse_;
};

}  // namespace curbstone::mapper::registration
