#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/keyframe.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::registration {

/// Order of every 6-dimensional quantity here: translation x y z, then rotation about X Y Z, in base_link axes.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Bits of RegistrationResult::degenerate: x, y and rotation about Z.
inline constexpr int kPlanarAxes = 0b100011;

/// Predicted pose of the vehicle and its uncertainty.
struct PosePrior {
  Pose T_map_base = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  ///< inverse covariance, in base_link axes
  double reach = 1e9;  ///< m: largest distance of a point from the map at this pose; bounds the search
};

/// Result of registering one scan.
struct RegistrationResult {
  Pose T_map_base = Pose::Identity();
  /// Covariance in base_link axes, from the equations of the last step, with the prior; groups of correlated points
  /// count as one point. It covers the noise of the points and of their planes, but not de-skew errors: without
  /// odometry, Tracker adds those (MotionJitterCovariance).
  Matrix6 covariance = Matrix6::Zero();
  double residual = 0;      ///< m, robust RMS distance of the inliers
  double inlier_ratio = 0;  ///< share of the points on a surface, among those for which the map had a surface
  double overlap = 0;       ///< 0..1: share of the scan's points for which the map had a surface
  int iterations = 0;
  int degenerate = 0;  ///< bit i: axis i of base_link was left to the prior
  bool converged = false;
};

class ShapeLevel;

/// Interface of a method that registers scans to a map, which it builds from them. make_registration() creates the two
/// implementations, `icp` and `loam`. Deterministic: the same calls give the same bits.
class Registration {
 public:
  virtual ~Registration() = default;

  /// Computes the pose of a de-skewed scan (points in base_link). Does not change the map.
  [[nodiscard]] virtual RegistrationResult align(const std::vector<scan::LidarPoint>& points,
                                                 const PosePrior& prior) = 0;
  /// Adds the scan to the map.
  virtual void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) = 0;
  /// Adds the points of a keyframe, with less detail than insert() of its scan.
  virtual void insert_keyframe(const scan::Keyframe& node) = 0;
  /// Bounds the map: drops whatever is farther than window() from `centre` in any axis. It does so only now and then,
  /// and returns true when it did.
  virtual bool keep_around(const Eigen::Vector3d& centre) = 0;
  [[nodiscard]] virtual double window() const = 0;  ///< m
  /// The levels of its voxel map, which are all that there is of it; always in the same order.
  [[nodiscard]] virtual std::vector<ShapeLevel*> levels() = 0;
  /// Number of voxels of the map, to which its memory is proportional.
  [[nodiscard]] virtual std::size_t size() const = 0;
};

}  // namespace curbstone::mapper::registration
