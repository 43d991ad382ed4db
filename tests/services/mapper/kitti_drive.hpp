#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <string>
#include <vector>

#include "common/geometry.hpp"

namespace curbstone::test {

/// A folder of scans in KITTI's layout, as the LiDAR would have sent them: the sweep begins behind and turns clockwise
/// (seen from above), the scan's stamp is when it looks forward.
struct KittiDrive {
  std::vector<std::int64_t> stamps;  ///< us
  std::vector<Pose> reference;       ///< T_scan0_scan, lidar frame, at the stamp
  std::string folder;
  std::int64_t period = 103'000;  ///< us a revolution

  [[nodiscard]] std::size_t size() const { return stamps.size(); }
  /// One revolution as packets. `deskewed` scans are sent as if all points were taken at once.
  [[nodiscard]] std::vector<lidar_points_t> packets(std::size_t scan) const;
};

/// Empty where the data is absent.
[[nodiscard]] KittiDrive load_kitti(const std::string& folder);

/// KITTI's relative error over sub-paths of 10, 20 ... 60 m, absolute error after rigid alignment, error at the end.
struct TrajectoryError {
  double t_rel_percent = 0;
  double r_rel_deg_per_m = 0;
  double ate_m = 0;
  double end_percent = 0;
  double length_m = 0;
};
[[nodiscard]] TrajectoryError compare(const std::vector<Pose>& estimate, const std::vector<Pose>& reference);

}  // namespace curbstone::test
