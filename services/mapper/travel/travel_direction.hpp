#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::travel {

/// Compares the motion by registration with that by odometry, stretch by stretch: direction and length on straight
/// stretches, angle in turns. A LiDAR that is turned on the vehicle seems to drive at an angle, one that is upside down
/// seems to turn the other way; wheels of another size give another length. Medians make slip and slipped registrations
/// harmless.
///
/// Keeps the last kMaxSamples straight stretches and the last kMaxSamples turns. Pure; one thread.
class TravelDirection {
 public:
  static constexpr double kStretch = 4.0;         ///< m
  static constexpr double kTurn = 0.06;           ///< rad
  static constexpr std::size_t kMinSamples = 10;  ///< stretches, or turns, before there is a result
  static constexpr std::size_t kMaxSamples = 16;

  /// Adds the next revolution, which fitted the map in every direction.
  void add(const Pose& T_map_base, const Pose& T_odom_base);
  /// Breaks the sequence: a revolution did not fit, or belongs to another map.
  void interrupt() { begin_.reset(); }

  /// Result of the straight stretches.
  struct Straight {
    double heading_offset = 0;  ///< rad, direction by the LiDAR, to the left of that by odometry
    double length_error = 0;    ///< length by odometry divided by that by the LiDAR, less 1
  };
  /// None before kMinSamples stretches, or if they do not agree.
  [[nodiscard]] std::optional<Straight> straight() const;
  /// Turn by the LiDAR divided by that by odometry: 1, or -1 if the LiDAR is upside down. None before kMinSamples
  /// turns, or if they do not agree.
  [[nodiscard]] std::optional<double> turning() const;

 private:
  struct Place {
    Pose T_map_base, T_odom_base;
  };
  std::optional<Place> begin_;
  std::deque<Straight> straights_;
  std::deque<double> turns_;
};

}  // namespace curbstone::mapper::travel
