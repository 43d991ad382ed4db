#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

namespace curbstone::bench::voting {

/// The comparison with PCL: surface normals and curvature from the covariance of all neighbours within a radius
/// (pcl::NormalEstimationOMP), as Debian builds it. PCL users determine the orientation of a surface this way.
class PclNormals {
 public:
  PclNormals(std::span<const Eigen::Vector3d> points, double radius, int threads);
  ~PclNormals();
  PclNormals(const PclNormals&) = delete;
  PclNormals& operator=(const PclNormals&) = delete;

  /// Builds the k-d tree and estimates all normals. Returns the number of points that have one.
  std::size_t run() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace curbstone::bench::voting
