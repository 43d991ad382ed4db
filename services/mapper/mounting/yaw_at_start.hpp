#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/azimuth_profile.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// Measures the error of the LiDAR's yaw in `vehicle.lidar` over the first metres of a drive: odometry tells the
/// direction of travel, and pairs of scans kBaseline apart show it, without a map, by their azimuth profiles: in the
/// right direction trunks, posts and walls are where they were. Where no surface stands across the street registration
/// follows odometry, and a LiDAR that looks 2 deg aside smears the map by decimetres.
///
/// All directions are tried. The result is the median of consistent pairs; it ends with that, or after kMaxWay.
/// Pure; one thread.
class YawAtStart {
 public:
  static constexpr double kBaseline = 2.0;      ///< m
  static constexpr double kMaxWay = 20.0;       ///< m of travel
  static constexpr std::size_t kPairs = 3;      ///< consistent ones
  static constexpr double kWrong = 0.02;        ///< rad, from here on the yaw is wrong; right ones show less than 0.008
  static constexpr double kWrongAgain = 0.005;  ///< rad, after a large correction
  static constexpr std::int64_t kMaxPairAge = 10'000'000;  ///< us between the scans of a pair

  /// `lidar`: position in base_link, m.
  explicit YawAtStart(const Eigen::Vector3d& lidar, double wrong = kWrong) : lidar_(lidar), wrong_(wrong) {}

  /// Takes the next scan: its end, us; its de-skewed points in base_link; the vehicle's pose by odometry. Returns,
  /// once, by how much the LiDAR looks to the left of what the file says (rad), if that is wrong.
  [[nodiscard]] std::optional<double> add(std::int64_t utime, const std::vector<scan::LidarPoint>& points,
                                          const Pose& T_odom_base);
  /// The next scan does not follow the last one, or odometry does not.
  void interrupt() { reference_.reset(); }

 private:
  struct Reference {
    std::int64_t utime;
    Pose T_odom_base;
    AzimuthProfile profile;
  };
  [[nodiscard]] std::optional<double> measure(const std::vector<scan::LidarPoint>& points,
                                              const Pose& T_reference_base) const;
  [[nodiscard]] std::optional<double> residual(const std::vector<scan::LidarPoint>& points,
                                               const Pose& T_reference_base, double yaw) const;

  Eigen::Vector3d lidar_;
  double wrong_;  // rad
  std::optional<Reference> reference_;
  double way_ = 0;               // m
  std::deque<double> measured_;  // rad
  bool is_over_ = false;
};

}  // namespace curbstone::mapper::mounting
