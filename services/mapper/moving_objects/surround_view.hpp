#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::moving_objects {

/// One revolution as a 2-D scan: in each direction from the LiDAR the nearest return of what is as tall as a vehicle.
/// Each return keeps the time at which it was measured, so that it can be placed both in base_link as it moves (where
/// what drives along stands still) and in odom (where the world does). A value, pure.
///
/// A place counts as empty only if nothing was there at kLow either: a laser meets a wall of 1 m within a certain range
/// above kTall, and beyond it below. That range moves with the vehicle.
class SurroundView {
 public:
  static constexpr int kBins = 360;       ///< of one degree
  static constexpr float kNear = 1.0F;    ///< m, horizontal range from the LiDAR
  static constexpr float kFar = 40.0F;    ///< m
  static constexpr float kLow = 0.15F;    ///< m above the vehicle's ground: anything that stands on it
  static constexpr float kTall = 1.0F;    ///< m
  static constexpr float kHigh = 3.0F;    ///< m
  static constexpr float kSlope = 0.03F;  ///< by which all three rise with the range

  /// Where the LiDAR is, and what it sees of the vehicle itself, in base_link, m.
  struct Mounting {
    Pose T_base_lidar = Pose::Identity();
    Eigen::AlignedBox3f own_body{};
  };
  /// The nearest return of something tall in a direction.
  struct Return {
    bool observed = false;                              ///< anything came back from there, be it the ground
    float time = 0;                                     ///< s after the scan's start; of any return
    float range = 0;                                    ///< m, horizontal, from the LiDAR; 0: nothing tall
    float any_range = 0;                                ///< m, the same of anything above kLow
    Eigen::Vector2f in_base = Eigen::Vector2f::Zero();  ///< m, in base_link at the time of the return
    Eigen::Vector2d in_odom = Eigen::Vector2d::Zero();  ///< m
  };

  /// `odometry` must cover the scan, whose points are in lidar.
  SurroundView(const scan::Scan& scan, const Mounting& mounting, const scan::OdometryHistory& odometry);

  [[nodiscard]] std::int64_t utime() const { return utime_; }
  [[nodiscard]] const Pose& T_odom_base() const { return T_odom_end_; }  ///< at the end of the scan
  [[nodiscard]] const Return& at(int bin) const { return returns_[wrapped(bin)]; }
  /// Whether the LiDAR measured the same range, in the same direction from the vehicle, in another revolution as it did
  /// here.
  [[nodiscard]] bool has_same_range(const SurroundView& other, int bin) const;
  /// The same for a range, m.
  [[nodiscard]] bool has_range(int bin, float range, float tolerance) const;
  /// Whether a place, m in odom, was empty: the LiDAR looked past it at something clearly beyond, or at the ground
  /// alone.
  [[nodiscard]] bool sees_through(const Eigen::Vector2d& in_odom) const;

  [[nodiscard]] static std::size_t wrapped(int bin) { return static_cast<std::size_t>((bin + 2 * kBins) % kBins); }
  /// The bin of a direction, m in base_link from the LiDAR.
  [[nodiscard]] static int bin_of(const Eigen::Vector2f& from_lidar);

 private:
  /// Pose of base_link in odom, in the plane, at a time in s after the scan's start.
  [[nodiscard]] Eigen::Isometry2d T_odom_base_at(float time) const;
  /// From the LiDAR at that time to a place in odom, in base_link, m.
  [[nodiscard]] Eigen::Vector2f from_lidar(const Eigen::Vector2d& in_odom, float time) const;

  std::int64_t utime_;
  Eigen::Vector2d lidar_;  // m, in base_link
  Pose T_odom_start_, T_odom_end_;
  float seconds_;  // of the scan
  std::array<Return, kBins> returns_{};
};

}  // namespace curbstone::mapper::moving_objects
