#include "tools/simulate/recorded/level.hpp"

#include <cmath>

#include "common/linear/decompositions.hpp"

namespace curbstone::simulate::recorded {

namespace {

/// Normal of the ground near the vehicle, in the lidar frame: a plane fitted to the points where ground is expected,
/// and refitted a few times to those near that plane.
Eigen::Vector3d ground_normal(const std::vector<ScanPoint>& points, double height) {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = -height, width = 0.35;  // normal . p = offset
  for (int round = 0; round < 5; ++round, width = std::max(0.08, 0.6 * width)) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double n = 0;
    for (const auto& point : points) {
      const Eigen::Vector3d p = point.position.cast<double>();
      const double range = p.head<2>().norm();
      if (range < 3.0 || range > 12.0 || std::abs(normal.dot(p) - offset) > width) continue;
      mean += p;
      squares += p * p.transpose();
      n += 1;
    }
    if (n < 100) break;
    mean /= n;
    normal = eigen_pairs<3>(squares / n - mean * mean.transpose()).vectors.col(0);
    if (normal.z() < 0) normal = -normal;
    offset = normal.dot(mean);
  }
  return normal;
}

}  // namespace

Eigen::Matrix3d level(const ScanSet& scans, double height) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  const std::size_t step = std::max<std::size_t>(1, scans.files.size() / 8);
  for (std::size_t i = 0; i < scans.files.size(); i += step)
    up += scans.T_first_scan[i].linear() * ground_normal(read_scan(scans.files[i]), height);
  const Eigen::Vector3d n = up.normalized();  // the rotation by the smallest angle takes it to z
  return Eigen::Quaterniond(1.0 + n.z(), n.y(), -n.x(), 0.0).normalized().toRotationMatrix();
}

}  // namespace curbstone::simulate::recorded
