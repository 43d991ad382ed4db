#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "services/mapper/voxels/block_index.hpp"

namespace curbstone::mapper::dense_map {

/// Tracks since when each coarse cell of space has been occupied without a break: a moving object does not stay in one
/// cell. Cells are 0.2 m wide and 0.6 m high, since the rings of a moving vehicle hit a wall at varying heights. Pure;
/// one thread.
class PersistenceFilter {
 public:
  static constexpr std::size_t kTogether = 64;  ///< points that are looked up together
  /// `persistence`: us that a place must have been occupied before it counts as static.
  explicit PersistenceFilter(std::int64_t persistence) : persistence_(persistence) {}

  /// Reports hits at `points` (m, map) at `utime` (us).
  void add_hits(std::span<const Eigen::Vector3d> points, std::int64_t utime);
  void add_hit(const Eigen::Vector3d& point, std::int64_t utime) { add_hits(std::span(&point, 1), utime); }
  /// Whether the point's place has been occupied for long enough.
  [[nodiscard]] bool is_static(const Eigen::Vector3d& point) const;
  /// Whether something not known to be static was within a metre above the point, or beside that, when the point was
  /// seen: wheels, feet and the lower halves of bumpers are low.
  [[nodiscard]] bool moving_above(const Eigen::Vector3d& point, std::int64_t utime) const;
  /// A point that may be of a moving object: if it is clear of the ground, unless it is_static(), else if something is
  /// moving_above() it.
  struct Suspect {
    Eigen::Vector3d point;  ///< m, map
    std::int64_t utime;     ///< us, when it was seen
    bool is_high;           ///< clear of the ground
  };
  /// Whether each of up to kTogether points may be of a moving object.
  void may_move(std::span<const Suspect> suspects, std::span<bool> may) const;

  /// Drops places without a hit after `utime`, us.
  void forget_before(std::int64_t utime);
  void clear();
  [[nodiscard]] std::size_t size() const { return places_.size(); }

 private:
  struct Place {
    Eigen::Vector3i cell;
    std::int64_t first;  // us
    std::int64_t last;   // us
  };
  void add_hit(const Eigen::Vector3i& cell, std::uint32_t at, std::int64_t utime);
  [[nodiscard]] bool is_static(const Place& place) const { return place.last - place.first >= persistence_; }

  std::int64_t persistence_;
  std::vector<Place> places_;
  voxels::BlockIndex index_;
};

}  // namespace curbstone::mapper::dense_map
