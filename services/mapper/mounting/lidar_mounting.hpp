#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/ground_below.hpp"
#include "services/mapper/mounting/travel_direction.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// A revolution that fitted the map.
struct FittedScan {
  std::int64_t utime = 0;                            ///< us, its end
  const std::vector<scan::LidarPoint>* points = {};  ///< de-skewed, in base_link
  Pose T_map_base = Pose::Identity();
  std::optional<Pose> T_odom_base;  ///< where odometry says how it moved
  bool in_every_direction = false;  ///< not left to odometry in any of the plane's
};

/// Whether the LiDAR is on the vehicle as `vehicle.lidar` says, and the wheels as large as `vehicle.wheel_radius`: the
/// usual mistakes on a new vehicle, and what a knock does on any. Asked are the ground in the strip that the vehicle
/// drives in (roll, pitch, height: GroundBelow) and the way that it drives (yaw, upside down, wheels: TravelDirection).
/// The map of such a vehicle fits together and is wrong: it leans, its curbs are beside where the vehicle meets them.
///
/// Limits are beyond what load, tyres and cambered roads do. Once something is said it is until it is less than
/// kSettled of the limit. A function of the calls. Pure; one thread. Counters: faults.lidar.tilted, .height, .turned,
/// .mirrored, faults.wheels.size.
class LidarMounting {
 public:
  static constexpr double kPitch = 0.026;  ///< rad
  static constexpr double kRoll = 0.035;   ///< rad
  static constexpr double kHeight = 0.12;  ///< m
  static constexpr double kYaw = 0.021;    ///< rad
  static constexpr double kLength = 0.04;  ///< share of the way
  static constexpr double kSettled = 0.75;

  explicit LidarMounting(const VehicleConfig& vehicle) : vehicle_(vehicle) {}

  void add(const FittedScan& scan);
  /// A revolution did not fit, or the map was rearranged.
  void interrupt();

  /// What is wrong: LiDAR leans, is too high or low, is turned, is mirrored, wheels are of another size.
  struct Wrong {
    bool tilt = false, height = false, yaw = false, mirrored = false, size = false;
    [[nodiscard]] bool any() const { return tilt || height || yaw || mirrored || size; }
  };
  [[nodiscard]] const Wrong& wrong() const { return wrong_; }
  /// x y z m, roll pitch yaw rad: vehicle.lidar as ground and way have it.
  [[nodiscard]] std::vector<double> lidar() const;
  /// The filter has learnt a part of what is wrong: this is the rest.
  [[nodiscard]] double wheel_radius() const { return vehicle_.wheel_radius / (1 + straight_.longer); }  ///< m
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void judge();

  VehicleConfig vehicle_;
  GroundBelow ground_;
  TravelDirection travel_;
  std::int64_t utime_ = 0;  // us, of the last revolution
  Pose T_map_base_ = Pose::Identity();
  Eigen::Vector3d looked_ = Eigen::Vector3d::Constant(1e9);  // m, map: where the ground was looked at last
  GroundPlane plane_;
  TravelDirection::Straight straight_;
  Wrong wrong_;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
