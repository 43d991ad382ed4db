#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::dense_map {

/// What a scan says about a place.
enum class Sighting {
  kNothing,  ///< no beam went there, or something nearer hides it
  kThere,    ///< a beam ended about there
  kThrough,  ///< beams went through it and ended well beyond
};

/// The beams of one scan by ring and azimuth: how far each went. Knows that the lidar moved meanwhile, so that
/// what is near is looked at from where the beam was fired. Pure.
class SweepImage {
 public:
  /// `points` as they are in base_link at the scan's end; `motion`: of base_link during it.
  SweepImage(const std::vector<scan::LidarPoint>& points, const Pose& T_base_lidar, const scan::Twist& motion);

  /// How near in range a beam must end to have met the place, and how far beyond it to have gone through; m.
  struct Margins {
    float there;
    float through;
  };
  /// A place in the lidar's axes at the scan's end. Through it went only what passed below a place lower than the
  /// lidar (above a higher one): what passes on its other side may have missed the edge or the top of a thing. And
  /// beside such a beam none may have ended sooner: a beam that grazes a wall does.
  [[nodiscard]] Sighting look(const Eigen::Vector3f& place, const Margins& margins) const;

 private:
  static constexpr int kAzimuths = 600;
  /// The shortest beam of half a degree of a ring.
  struct Beam {
    float range = 0;  // m, horizontally; 0: none
    float slope = 0;  // up, per m
  };
  [[nodiscard]] static int azimuth_of(float x, float y);
  /// A ring, and how it is inclined on average.
  struct Row {
    float slope;
    std::size_t ring;
  };

  std::vector<Beam> beams_;   // ring by ring
  std::vector<Row> rows_;     // from the lowest
  std::vector<float> ages_;   // s before the end, by azimuth
  Eigen::Vector3f velocity_;  // m/s, of the lidar, in its axes
};

}  // namespace curbstone::mapper::dense_map
