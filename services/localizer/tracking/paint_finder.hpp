#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/intensity/ring_scale.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::localizer::tracking {

/// Finds the returns that may be of paint: a piece of a ring on the ground that is bright, at most kLongest m long,
/// between two that are not. Intensities are compared on the scale that all rings share, which is learned on the way
/// (`mapper/intensity`). Pavements and lawns are longer, and so is all the ground where the intensities are wrong. What
/// remains does no harm: only returns beside the map's paint are used. One thread.
class PaintFinder {
 public:
  static constexpr int kBright = 100;      ///< of 255; the road's median is 64
  static constexpr float kLongest = 2.0F;  ///< m along the ring: one that touches a line runs along it
  static constexpr float kReach = 15.0F;   ///< m from base_link, in x and y: farther away, few beams hit a dash

  /// Learns from the revolution, if the vehicle has moved, and returns its points of paint, ring by ring. `points`:
  /// de-skewed, in base_link, those of a ring in the order of their azimuth; the result is in base_link.
  [[nodiscard]] std::vector<Eigen::Vector3d> find(const std::vector<mapper::scan::LidarPoint>& points,
                                                  const Pose& T_odom_base);

 private:
  mapper::intensity::RingScale scale_;
};

}  // namespace curbstone::localizer::tracking
