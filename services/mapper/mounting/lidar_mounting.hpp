#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/ground_plane_estimator.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/travel/lever_arm.hpp"
#include "services/mapper/travel/travel_direction.hpp"

namespace curbstone::mapper::mounting {

/// A revolution that registration matched to the map.
struct RegisteredScan {
  std::int64_t utime = 0;                            ///< us, its end
  const std::vector<scan::LidarPoint>* points = {};  ///< de-skewed, in base_link
  Pose T_map_base = Pose::Identity();
  std::optional<Pose> T_odom_base;    ///< pose by odometry
  bool is_fully_constrained = false;  ///< no planar direction (x, y, yaw) was left to odometry
};

/// Checks that the LiDAR is mounted as `vehicle.lidar` says, and that the wheels match `vehicle.wheel_radius`: the
/// usual mistakes on a new vehicle, and the effect of a knock on any. Roll, pitch and height come from the ground in
/// the strip that the vehicle drives in (GroundPlaneEstimator); yaw, upside down and wheel size from its direction of
/// travel (TravelDirection); x and y from bends (LeverArm). With a wrong mounting the map is consistent but wrong: it
/// leans, and its curbs are displaced from the real ones.
///
/// Ranges that are too long by some percent make the ground as many percent too deep and the way by LiDAR as much too
/// long: neither the height nor the wheels are blamed where both agree (detection::RangeScale names larger factors).
///
/// The limits are beyond the effect of load, tyres and cambered roads. A fault stays raised until the value is below
/// kSettled of the limit. A function of the calls. Pure; one thread. Counters: faults.lidar.tilted, .height, .turned,
/// .displaced, .mirrored, .ranges, faults.wheels.size.
class LidarMounting {
 public:
  static constexpr double kPitch = 0.026;   ///< rad
  static constexpr double kRoll = 0.035;    ///< rad
  static constexpr double kHeight = 0.12;   ///< m
  static constexpr double kYaw = 0.021;     ///< rad
  static constexpr double kAhead = 0.2;     ///< m: tyres that slide outwards look like 0.1
  static constexpr double kAside = 0.15;    ///< m
  static constexpr double kFewBends = 0.5;  ///< m: the limits of both are this, divided by the number of bends, more
  static constexpr double kLength = 0.04;   ///< share of the distance driven
  static constexpr double kRanges = 0.022;  ///< share by which ranges are too long or short, by ground and way, and
  static constexpr double kRangesDepth = 0.03;   ///< m: by the ground alone; it is known to a centimetre
  static constexpr double kRangesAgree = 0.012;  ///< by which both may differ, or
  static constexpr double kRangesAlike = 0.2;    ///< of the share
  static constexpr double kSettled = 0.75;

  explicit LidarMounting(const VehicleConfig& vehicle) : vehicle_(vehicle) {}

  void add(const RegisteredScan& scan);
  /// Breaks the sequence: a revolution did not fit, or the map was rearranged.
  void interrupt();

  /// Whether scans turn the other way than odometry, by all of them, also those that did not fit the map. The turns of
  /// those that fitted count for more, once there are enough.
  void set_turns_opposite(bool opposite);

  /// Whether the LiDAR's stamps are late or early: that may look like another place.
  void set_stamps_are_wrong(bool wrong) { stamps_are_wrong_ = wrong; }

  /// Current faults: the LiDAR leans, is too high or low, is turned, is too far ahead, behind or aside, is mirrored;
  /// its ranges are too long or short; the wheels are of another size.
  struct Wrong {
    bool tilt = false, height = false, yaw = false, place = false, mirrored = false, size = false, ranges = false;
    [[nodiscard]] bool any() const { return tilt || height || yaw || place || mirrored || size || ranges; }
  };
  [[nodiscard]] const Wrong& wrong() const { return wrong_; }
  /// x y z in m, roll pitch yaw in rad: the `vehicle.lidar` that ground and direction of travel suggest.
  [[nodiscard]] std::vector<double> lidar() const;
  /// m. The odometry filter has already learnt part of the error: this corrects the rest.
  [[nodiscard]] double wheel_radius() const { return vehicle_.wheel_radius / (1 + straight_.length_error); }  ///< m
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void judge();
  void judge_mirrored();
  void judge_place();
  void judge_ranges();
  [[nodiscard]] bool is_beyond_ahead() const;
  [[nodiscard]] bool is_beyond_aside() const;
  [[nodiscard]] std::string place_fault() const;

  VehicleConfig vehicle_;
  GroundPlaneEstimator ground_;
  travel::TravelDirection travel_;
  travel::LeverArm arm_;
  std::int64_t utime_ = 0;  // us, of the last revolution
  Pose T_map_base_ = Pose::Identity();
  Eigen::Vector3d looked_ = Eigen::Vector3d::Constant(1e9);  // m, map: where the ground was last observed
  GroundPlane plane_;
  travel::TravelDirection::Straight straight_;
  double range_error_ = 0;  // share by which ranges are too long, by the way driven
  bool stamps_are_wrong_ = false;
  travel::LeverArm::Excess excess_;  // of vehicle.lidar's x and y
  bool turns_opposite_ = false;
  Wrong wrong_;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
