#include "tools/bench/voting/pcl_normals.hpp"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <algorithm>

namespace curbstone::bench::voting {

struct PclNormals::Impl {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZ>};
  double radius;
  unsigned threads;
};

PclNormals::PclNormals(std::span<const Eigen::Vector3d> points, double radius, int threads)
    : impl_(std::make_unique<Impl>()) {
  impl_->radius = radius;
  impl_->threads = static_cast<unsigned>(threads);
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3f f = p.cast<float>();
    impl_->cloud->push_back({f.x(), f.y(), f.z()});
  }
}

PclNormals::~PclNormals() = default;

std::size_t PclNormals::run() const {
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(impl_->threads);
  estimation.setInputCloud(impl_->cloud);
  estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  estimation.setRadiusSearch(impl_->radius);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  return static_cast<std::size_t>(
      std::count_if(normals.begin(), normals.end(), [](const pcl::Normal& n) { return std::isfinite(n.normal_z); }));
}

}  // namespace curbstone::bench::voting
