#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/azimuth_profile.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// Measures the scale of odometry's distance by the azimuth profiles of the scans. Tyres of another radius or a wrong
/// gear ratio make it wrong by percents, until the filter has learnt it from the IMU. Where only trees stand,
/// registration has no surface across the street that would show it, and follows odometry.
///
/// A scan is compared with a reference scan kBaseline back, at several scales of odometry's way between them: at the
/// right one, trunks and posts beside the street are where they were. In simulated streets a comparison scatters by
/// half a percent. It finds the way one percent too short, as ranges that only one of the scans has are fewer then, and
/// up to five percent beside a lorry that overtakes. So what is corrected is odometry that is too short by kMinShort,
/// or too long by kMinLong; less is left to registration. Pure; one thread.
class ScaleByScans {
 public:
  static constexpr double kBaseline = 2.0;            ///< m
  static constexpr std::int64_t kMaxAge = 4'000'000;  ///< us, of a reference
  static constexpr std::size_t kWindow = 5;           ///< comparisons; the median counts, if they are consistent
  static constexpr double kMinShort = 0.025;          ///< smallest error that is corrected: odometry is too short,
  static constexpr double kMinLong = 0.05;            ///< or too long
  static constexpr double kMaxError = 0.24;           ///< of the scale, beyond which it is not measured

  /// `lidar`: position in base_link, m.
  explicit ScaleByScans(const Eigen::Vector3d& lidar) : lidar_(lidar) {}

  /// Takes the next scan: its end, us; its de-skewed points in base_link; the vehicle's pose in the map, of which the
  /// turn is used, and by odometry, of which the way is used.
  void add(std::int64_t utime, const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
           const Pose& T_odom_base);
  /// The next scan does not follow the last one, or the map's frame has moved.
  void interrupt() { reference_.reset(); }
  /// Factor by which odometry's way must be multiplied; 1 while no error is certain.
  [[nodiscard]] double scale() const { return scale_; }

 private:
  struct Reference {
    std::int64_t utime;
    Pose T_map_base;
    Pose T_odom_base;
    AzimuthProfile profile;
  };
  [[nodiscard]] std::optional<double> measure(const std::vector<scan::LidarPoint>& points,
                                              const Pose& T_reference_base) const;
  void conclude(double measured);

  Eigen::Vector3d lidar_;
  std::optional<Reference> reference_;
  std::deque<double> measured_;  // scales, at most kWindow
  double scale_ = 1;
};

}  // namespace curbstone::mapper::mounting
