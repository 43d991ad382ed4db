#pragma once

#include <array>
#include <cstddef>

#include "drivers/lidar/models/robosense/magic.hpp"

namespace curbstone::lidar::models::rs16 {

using Rs16Packet = robosense::RawPacket;

/// Constants of the RS-LiDAR-16: 16 lasers that fire one after another while the head turns clockwise (seen from
/// above). One pass over the 16 is a firing sequence. Source: RS-LiDAR-16 user manual, appendix A; rs_driver 4eeadace.
inline constexpr int kLasers = 16;
inline constexpr double kLaserPeriod = 2.8e-6;      ///< s, from one laser to the next
inline constexpr double kSequencePeriod = 55.5e-6;  ///< s, from one firing sequence to the next
inline constexpr int kSequencesPerBlock = 2;        ///< single return
inline constexpr int kBlocksPerPacket = 12;
inline constexpr int kSequencesPerPacket = kSequencesPerBlock * kBlocksPerPacket;
inline constexpr double kBlockPeriod = kSequencesPerBlock * kSequencePeriod;

/// Intervals of the shots.
struct FiringTimes {
  double laser = kLaserPeriod;        ///< s
  double sequence = kSequencePeriod;  ///< s
  bool operator==(const FiringTimes&) const = default;
};
/// Of firmware with distances in cm (ros_rslidar 726eacca, rawdata.h).
inline constexpr FiringTimes kOldFiringTimes = {3.0e-6, 50.0e-6};

/// m, distance of the lens from the axis, in the direction of the beam.
inline constexpr double kLensOffset = 0.03825;

using ElevationTable = std::array<double, kLasers>;  ///< deg above the horizon, by laser in firing order

/// The second half descends from +15. A device's own table is in its DIFOP packets.
inline constexpr ElevationTable kNominalElevations = {-15, -13, -11, -9, -7, -5, -3, -1, 15, 13, 11, 9, 7, 5, 3, 1};

}  // namespace curbstone::lidar::models::rs16
