#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::localizer::search {

/// Several revolutions joined by odometry: the upright structures around the vehicle, denser and seen from more sides
/// than in one revolution. One thread; bounded.
class LocalScan {
 public:
  static constexpr std::size_t kMaxRevolutions = 60;

  /// Adds a revolution. `points`: thinned, in base_link. T_odom_base: the odom frame is level.
  void add(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base);
  void clear();

  /// The positions of upright structures in plan: m from `T_odom_base`, x along the vehicle, within `reach`, one
  /// position in each square of 0.5 m, at most `most` of them.
  [[nodiscard]] std::vector<Eigen::Vector2d> plan(const Pose& T_odom_base, double reach, std::size_t most) const;

  [[nodiscard]] std::size_t revolutions() const { return revolutions_; }
  /// Length of the path from the first revolution to the last; m.
  [[nodiscard]] double driven() const { return driven_; }

 private:
  std::size_t revolutions_ = 0;
  double driven_ = 0;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points_;  // in odom
};

}  // namespace curbstone::localizer::search
