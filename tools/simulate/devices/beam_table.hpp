#pragma once

#include <span>
#include <vector>

#include "tools/simulate/devices/lidar_emulator.hpp"

namespace curbstone::simulate::devices {

/// The mounting of one laser in the rotating head, and when it fires.
struct LaserMount {
  double time = 0;       ///< s after the firing's first shot
  double elevation = 0;  ///< deg above the horizon
  double azimuth = 0;    ///< deg relative to the head's azimuth, clockwise
  double height = 0;     ///< m, of the lens above the optical centre
};

/// The beams of a rotating head.
class BeamTable {
 public:
  /// `lens_offset` in m, in the direction of the head; `rate` in deg/s, clockwise.
  BeamTable(std::vector<LaserMount> lasers, double lens_offset, double rate)
      : lasers_(std::move(lasers)), lens_offset_(lens_offset), rate_(rate) {}

  [[nodiscard]] const std::vector<LaserMount>& lasers() const { return lasers_; }
  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] std::vector<double> elevations_deg() const;
  /// The beams of a firing that starts with the head at this azimuth.
  void beams(double azimuth_deg, std::span<LidarRay> by_laser) const;

 private:
  std::vector<LaserMount> lasers_;
  double lens_offset_;
  double rate_;
};

}  // namespace curbstone::simulate::devices
