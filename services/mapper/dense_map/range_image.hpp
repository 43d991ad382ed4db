#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::dense_map {

/// What a scan shows about a place.
enum class Occupancy {
  kUnknown,   ///< no beam went there, or something nearer occludes it
  kOccupied,  ///< a beam ended near it
  kFree,      ///< beams passed through it and ended well beyond
};

/// Range image of one scan: range by ring and azimuth. It accounts for the motion of the lidar during the scan, so that
/// near objects are seen from where the beam was fired. Pure.
class RangeImage {
 public:
  /// `points`: in base_link at the scan's end; `motion`: of base_link during the scan.
  RangeImage(const std::vector<scan::LidarPoint>& points, const Pose& T_base_lidar, const scan::Twist& motion);

  /// Tolerances in range, m: a beam that ends within `hit` met the place, one that ends beyond `pass` passed it.
  struct Margins {
    float hit;
    float pass;
  };
  /// Classifies a place, given in the lidar's axes at the scan's end. A beam counts as passing through a place lower
  /// than the lidar only if it passed below it (above, for a place higher than the lidar): on the other side it may
  /// have missed the edge or the top of an object. Neighbouring beams must not have ended sooner: that happens where a
  /// beam grazes a wall.
  [[nodiscard]] Occupancy classify(const Eigen::Vector3f& place, const Margins& margins) const;

 private:
  static constexpr int kAzimuths = 600;
  /// The shortest beam within half a degree of azimuth, on one ring.
  struct Beam {
    float range = 0;  // m, horizontally; 0: none
    float slope = 0;  // up, per m
  };
  [[nodiscard]] static int azimuth_of(float x, float y);
  /// A ring and its mean slope.
  struct Row {
    float slope;
    std::size_t ring;
  };

  std::vector<Beam> beams_;    // ring by ring
  std::vector<Row> rows_;      // in order of slope, the lowest first
  std::vector<float> slopes_;  // of rows_, beside each other
  std::vector<float> ages_;    // s before the end, by azimuth
  Eigen::Vector3f velocity_;   // m/s, of the lidar, in its axes
};

}  // namespace curbstone::mapper::dense_map
