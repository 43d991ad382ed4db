#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::mounting {

/// Compares the way driven by the LiDAR with that by odometry, stretch by stretch: straight ones in which direction it
/// led and how far, turns by how much it turned. A LiDAR that is turned on the vehicle seems to drive aslant, one that
/// is upside down to turn the other way; wheels of another size drive another way. Medians, so that slip and a
/// registration that slid count for nothing.
///
/// Remembers the last kMost of either. Pure; one thread.
class TravelDirection {
 public:
  static constexpr double kStretch = 4.0;    ///< m
  static constexpr double kTurn = 0.06;      ///< rad
  static constexpr std::size_t kLeast = 10;  ///< before anything is said
  static constexpr std::size_t kMost = 16;

  /// The next revolution, which fitted the map in every direction.
  void add(const Pose& T_map_base, const Pose& T_odom_base);
  /// What comes now has nothing to do with what came before: it did not fit, or is another map's.
  void interrupt() { begin_.reset(); }

  /// Of straight stretches.
  struct Straight {
    double aslant = 0;  ///< rad, the LiDAR's way to the left of odometry's
    double longer = 0;  ///< odometry's way by the LiDAR's, less 1
  };
  /// Nothing before kLeast, or where they do not agree.
  [[nodiscard]] std::optional<Straight> straight() const;
  /// The LiDAR's turns by odometry's: 1, or -1 of a LiDAR that is upside down. Likewise.
  [[nodiscard]] std::optional<double> turning() const;

 private:
  struct Place {
    Pose T_map_base, T_odom_base;
  };
  std::optional<Place> begin_;
  std::deque<Straight> straights_;
  std::deque<double> turns_;
};

}  // namespace curbstone::mapper::mounting
