#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/yaw_at_start.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper {

/// Corrects `vehicle.lidar` over the first metres of a new map: the roll of a LiDAR that hangs upside down
/// (returns::GroundInSight), and the yaw of one that looks aside (mounting::YawAtStart). All that was mapped before a
/// correction is wrong: the map has to begin again.
///
/// A large error of the yaw falsified the de-skew, too, and with it the measurement: that is repeated.
///
/// A function of the calls. Pure; one thread. Counters: lidar_turned, lidar_turned_over.
class LidarAtStart {
 public:
  static constexpr double kStartOfDrive = 50;  ///< m from its origin, within which a map may begin again
  static constexpr double kLargeYaw = 0.17;    ///< rad

  /// A revolution that is part of the map.
  struct Look {
    std::int64_t utime = 0;                            ///< us, its end
    const std::vector<scan::LidarPoint>* points = {};  ///< de-skewed, in base_link
    Pose T_map_base = Pose::Identity();
    std::optional<Pose> T_odom_base;  ///< nothing if odometry has no gyro
    bool is_upside_down = false;      ///< so far, by the ground
  };

  explicit LidarAtStart(const VehicleConfig& vehicle)
      : position_(vehicle.T_base_lidar().translation()), lidar_(vehicle.lidar) {}

  /// A new map begins: without this call nothing is corrected.
  void begin() { yaw_at_start_.emplace(position_); }
  /// Takes the next revolution. Returns why the map has to begin again, if lidar() has changed.
  [[nodiscard]] std::optional<std::string> add(const Look& look);
  /// x y z in m, roll pitch yaw in rad: `vehicle.lidar`, corrected.
  [[nodiscard]] const std::vector<double>& lidar() const { return lidar_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void turn(double yaw);
  void turn_over();

  Eigen::Vector3d position_;  // m, in base_link
  std::vector<double> lidar_;
  std::optional<mounting::YawAtStart> yaw_at_start_;  // while something may still be corrected
  bool turned_over_ = false;                          // the roll was corrected by half a turn
  double turned_ = 0;                                 // rad, by which the yaw was corrected
  Counters counters_;
};

}  // namespace curbstone::mapper
