#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "services/mapper/travel/travel_direction.hpp"

namespace curbstone::mapper::travel {

/// Estimates how far ahead or aside of its place in `vehicle.lidar` the LiDAR is. On a straight road that does not
/// show. In a bend each point of the vehicle goes its own way: odometry gives the motion of base_link, registration
/// that of the point that it takes for base_link, which is d off. The two translations differ by (I - R) d, R the turn.
///
/// Wheels of another size and a LiDAR that looks aside have an effect in bends too; it is taken out by what straight
/// stretches say. Tyres that slide outwards look like a LiDAR that is further back, so bends above kMaxSpeed are left
/// out. Stamps that are late have an effect where a bend begins or ends only. The first bends are less certain: the
/// filter is still learning where the axle is.
///
/// Keeps the last kMaxBends bends. Pure; one thread.
class LeverArm {
 public:
  static constexpr double kTurn = 0.5;         ///< rad, of a bend
  static constexpr double kMaxWay = 12.0;      ///< m, of a bend
  static constexpr double kMaxSpeed = 4.0;     ///< m/s, mean of a bend: tyres slide by 0.1 m or so of d
  static constexpr std::size_t kMinBends = 3;  ///< before there is a result
  static constexpr std::size_t kMaxBends = 16;

  /// By how much `vehicle.lidar` is more than the LiDAR's place.
  struct Excess {
    Eigen::Vector2d by = Eigen::Vector2d::Zero();  ///< m, x and y in base_link
    std::size_t bends = 0;                         ///< from which it is
  };

  /// Adds the next revolution, which fitted the map in every direction.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// Breaks the sequence: a revolution did not fit, or belongs to another map.
  void interrupt() { places_.clear(); }

  /// `straight`: what the straight stretches say. None before kMinBends bends, or if they do not agree.
  [[nodiscard]] std::optional<Excess> excess(const TravelDirection::Straight& straight) const;

 private:
  struct Place {
    std::int64_t utime = 0;  // us
    Pose T_map_base, T_odom_base;
  };
  /// The motion from one place to another.
  struct Bend {
    double turn = 0;                      // rad
    double speed = 0;                     // m/s, negative in reverse
    Eigen::Vector2d by_map, by_odometry;  // m
  };
  [[nodiscard]] static Bend between(const Place& from, const Place& to);

  std::deque<Place> places_;  // of the last kMaxWay
  std::deque<Bend> bends_;
};

}  // namespace curbstone::mapper::travel
