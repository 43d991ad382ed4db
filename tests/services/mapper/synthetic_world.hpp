#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <functional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::test {

/// A world of boxes on a flat ground, seen by a LiDAR of 16 beams (-15..15 deg) and 900 columns a revolution.
struct SyntheticWorld {
  struct Box {
    Eigen::Vector3d low, high;
  };
  bool ground = true;  ///< z = 0
  std::vector<Box> boxes;
  double noise = 0;  ///< m, 1 sigma, of a range; deterministic

  /// Distance along a unit direction; infinity for none within 100 m.
  [[nodiscard]] double range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// T_world_base at a time in s.
  using Trajectory = std::function<Pose(double)>;
  /// What one revolution of `period` s, beginning at `start` s, sends: packets of 24 columns, turning clockwise.
  [[nodiscard]] std::vector<lidar_points_t> packets(const Trajectory& trajectory, const Pose& T_base_lidar,
                                                    int revolution, double start, double period) const;
  /// The same, as seen by a vehicle that stands, in base_link.
  [[nodiscard]] std::vector<mapper::scan::LidarPoint> snapshot(const Pose& T_world_base,
                                                               const Pose& T_base_lidar) const;

  static constexpr int kPackets = 38;
  static constexpr std::int64_t kEpoch = 1'700'000'000'000'000;  ///< us, of 0 s
};

/// A street corner: ground, house fronts, two parked cars, a pole: everything well constrained.
[[nodiscard]] SyntheticWorld street();
/// Two endless walls and the ground: nothing tells how far along.
[[nodiscard]] SyntheticWorld tunnel();
/// Nothing but the ground.
[[nodiscard]] SyntheticWorld plain();

/// The default vehicle's lidar.
[[nodiscard]] Pose default_lidar();
[[nodiscard]] Pose pose(double x, double y, double z, double roll, double pitch, double yaw);

}  // namespace curbstone::test
