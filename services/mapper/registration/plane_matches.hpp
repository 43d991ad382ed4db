#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::registration {

/// How much a distance counts in one step.
struct RobustKernel {
  double reach;  ///< m: what is farther from its plane does not count
  double bound;  ///< m: Huber's, at least a sigma of the match
};

/// Points and the planes that they were matched to, as seen from base_link then: a step of Gauss-Newton on them is
/// arithmetic alone, in lanes of four floats. All is relative to base_link, so floats serve wherever the map is. The
/// sums are added up in one order: the same bits every time.
class PlaneMatches {
 public:
  void clear() { fours_.clear(), size_ = 0; }
  /// `p` m, `n` unit, in base_link; `distance` m of p along n from the plane; `variance` m^2 of such a distance.
  void add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, double distance, double variance);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// The equations once base_link has moved by `moved` since the points were matched.
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
