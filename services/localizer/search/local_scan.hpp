#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::localizer::search {

/// Some revolutions joined by odometry: what stands about the vehicle, denser and from more sides than one revolution
/// shows it. One thread; bounded.
class LocalScan {
 public:
  static constexpr std::size_t kMostRevolutions = 60;

  /// `points`: thinned, in base_link. T_odom_base: odom is level.
  void add(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base);
  void clear();

  /// Where something stands, from above: m from `T_odom_base`, x along the vehicle, within `reach`, one place in a
  /// square of 0.5 m, at most `most` of them.
  [[nodiscard]] std::vector<Eigen::Vector2d> plan(const Pose& T_odom_base, double reach, std::size_t most) const;

  [[nodiscard]] std::size_t revolutions() const { return revolutions_; }
  /// From the first revolution to the last, along the way; m.
  [[nodiscard]] double driven() const { return driven_; }

 private:
  std::size_t revolutions_ = 0;
  double driven_ = 0;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points_;  // in odom
};

}  // namespace curbstone::localizer::search
