#include "services/mapper/registration/plane_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::mapper::registration {
namespace {

constexpr std::size_t kTogether = ShapeLevel::kTogether;

}  // namespace

PlaneMap::PlaneMap(const Options& options)
    : fine_({.voxel = options.fine_voxel, .min_width = 0.4 * options.fine_voxel, .min_grazing = options.min_grazing}),
      coarse_({.voxel = options.coarse_voxel,
               .capacity = 100,
               .min_points = 10,
               .min_width = 0.3 * options.coarse_voxel,
               .min_grazing = options.min_grazing}) {}

void PlaneMap::planes_at(std::span<const Eigen::Vector3d> points, double reach, std::span<const MapShape*> planes) {
  std::array<ShapeLevel::Place, kTogether> places;
  std::array<Eigen::Vector3d, kTogether> sparse;  // points without a fine plane within reach
  std::array<std::size_t, kTogether> numbers;
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    const std::size_t end = std::min(begin + kTogether, points.size());
    fine_.find(points.subspan(begin, end - begin), places);
    std::size_t num_sparse = 0;
    for (std::size_t i = begin; i < end; ++i) {
      planes[i] = fine_.shape_at(points[i], places[i - begin]);
      const bool fits =
          planes[i] != nullptr && std::abs(planes[i]->axis.cast<double>().dot(points[i] - planes[i]->mean)) < reach;
      if (fits) continue;
      sparse[num_sparse] = points[i];
      numbers[num_sparse++] = i;
    }
    coarse_.find({sparse.data(), num_sparse}, places);
    for (std::size_t k = 0; k < num_sparse; ++k) {
      const MapShape* coarse = coarse_.shape_at(sparse[k], places[k]);
      if (coarse != nullptr) planes[numbers[k]] = coarse;
    }
  }
}

const MapShape* PlaneMap::plane_at(const Eigen::Vector3d& point, double reach) {
  const MapShape* plane = nullptr;
  planes_at({&point, 1}, reach, {&plane, 1});
  return plane;
}

void PlaneMap::insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                      const Eigen::Vector3f& lidar) {
  const Eigen::Matrix3f R = T_map_base.linear().cast<float>();
  std::array<Eigen::Vector3d, kTogether> in_map;
  std::array<Eigen::Vector3f, kTogether> rays;
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    const std::size_t size = std::min(kTogether, points.size() - begin);
    for (std::size_t i = 0; i < size; ++i) {
      const Eigen::Vector3f& p = points[begin + i].position;
      in_map[i] = T_map_base * p.cast<double>();
      rays[i] = R * (p - lidar).normalized();
    }
    fine_.insert(std::span(in_map.data(), size), std::span(rays.data(), size));
    coarse_.insert(std::span(in_map.data(), size), std::span(rays.data(), size));
  }
  fine_.end_insertion();
  coarse_.end_insertion();
}

void PlaneMap::keep_around(const Eigen::Vector3d& centre, double radius) {
  fine_.keep_around(centre, radius);
  coarse_.keep_around(centre, radius);
}

}  // namespace curbstone::mapper::registration
