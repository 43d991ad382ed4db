#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::registration {

/// Weighting of the distances in one step.
struct RobustKernel {
  double reach;  ///< m: points farther than this from their plane are ignored
  double bound;  ///< m: bound of the Huber kernel, at least a sigma of the match
};

/// Points and their corresponding planes, in base_link at the time of matching. A Gauss-Newton step on them is pure
/// arithmetic, four floats a lane. All coordinates are relative to base_link, so floats suffice wherever the map is.
/// The order of summation is fixed: the result is bit-identical on every run.
class PlaneMatches {
 public:
  void clear() { fours_.clear(), size_ = 0; }
  /// `p` in m and unit normal `n`, in base_link; `distance`: m, of p from the plane along n; `variance`: m^2, of that
  /// distance.
  void add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, double distance, double variance);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// The equations after base_link has moved by `moved` since the matching.
  [[nodiscard]] NormalEquations at(const Pose& moved, const RobustKernel& kernel) const;

 private:
  using Lanes = float __attribute__((vector_size(16)));
  static constexpr std::size_t kLanes = 4;
  struct Four {
    Lanes p[3];
    Lanes n[3];
    Lanes distance;
    Lanes sigma;
  };
  struct Sums;

  std::vector<Four> fours_;
  std::size_t size_ = 0;
};

}  // namespace curbstone::mapper::registration
