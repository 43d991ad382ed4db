#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/keyframe.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::registration {

/// Rows and columns of everything 6-dimensional here: translation x y z, then rotation about X Y Z, in base_link axes.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Bits of RegistrationResult::degenerate: x, y and rotation about Z.
inline constexpr int kPlanarAxes = 0b100011;

/// Where the vehicle should be, and how well that is known.
struct PosePrior {
  Pose T_map_base = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  ///< inverse covariance, in base_link axes
  double reach = 1e9;  ///< m: nothing is farther from where this pose puts it: surfaces need not be sought beyond
};

/// What came of registering one scan.
struct RegistrationResult {
  Pose T_map_base = Pose::Identity();
  /// In base_link axes: of the step's equations, a point among many counted as one, with the prior. It knows the
  /// points' noise and their planes', not what de-skew got wrong (Tracker adds that, where there is no odometry:
  /// MotionJitterCovariance).
  Matrix6 covariance = Matrix6::Zero();
  double residual = 0;      ///< m, robust RMS distance of the inliers
  double inlier_ratio = 0;  ///< of the points for which the map had a surface, those that lie on it
  double overlap = 0;       ///< 0..1: share of the scan's points for which the map had a surface
  int iterations = 0;
  int degenerate = 0;  ///< bit i: axis i of base_link was left to the prior
  bool converged = false;
};

/// A way to register scans to the map that it keeps of them. `icp` and `loam` are two, by make_registration().
/// Deterministic: the same calls give the same bits.
class Registration {
 public:
  virtual ~Registration() = default;

  /// Finds the pose of a de-skewed scan (points in base_link). Leaves the map as it is.
  [[nodiscard]] virtual RegistrationResult align(const std::vector<scan::LidarPoint>& points,
                                                 const PosePrior& prior) = 0;
  /// Adds the scan to the map.
  virtual void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) = 0;
  /// Adds what a node of the drive remembers, with less detail than insert() of its scan had.
  virtual void recall(const scan::Keyframe& node) = 0;
  /// Bounds the map: whatever is farther than window() from `centre` in any axis is forgotten. Now and then: true when
  /// it was.
  virtual bool keep_around(const Eigen::Vector3d& centre) = 0;
  [[nodiscard]] virtual double window() const = 0;  ///< m
  /// Voxels of its map: what its memory goes with.
  [[nodiscard]] virtual std::size_t size() const = 0;
};

}  // namespace curbstone::mapper::registration
