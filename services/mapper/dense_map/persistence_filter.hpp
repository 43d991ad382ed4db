#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/mapper/voxels/block_index.hpp"

namespace curbstone::mapper::dense_map {

/// Coarse cells of space above the ground (0.2 m, 0.6 m high: the rings of a passing vehicle hit a wall now here, now
/// there), and since when each has been seen occupied without a break: what moves does not stay in one. Pure; one
/// thread.
class PersistenceFilter {
 public:
  /// `persistence`: us that a place must have been seen occupied until it counts as staying.
  explicit PersistenceFilter(std::int64_t persistence) : persistence_(persistence) {}

  /// Something is at `point` (m, map) at `utime` (us).
  void see(const Eigen::Vector3d& point, std::int64_t utime);
  /// Whether the point's place has been occupied for long enough.
  [[nodiscard]] bool stays(const Eigen::Vector3d& point) const;
  /// Whether something that is not known to stay was up to a metre above the point, or beside that, when the point was
  /// seen: a wheel, a foot and the lower half of a bumper are low.
  [[nodiscard]] bool passing_above(const Eigen::Vector3d& point, std::int64_t utime) const;

  /// Forgets places where nothing was seen after `utime`.
  void forget_before(std::int64_t utime);
  void clear();
  [[nodiscard]] std::size_t size() const { return places_.size(); }

 private:
  struct Place {
    Eigen::Vector3i cell;
    std::int64_t first;  // us
    std::int64_t last;   // us
  };
  [[nodiscard]] bool stays(const Place& place) const { return place.last - place.first >= persistence_; }

  std::int64_t persistence_;
  std::vector<Place> places_;
  voxels::BlockIndex index_;
};

}  // namespace curbstone::mapper::dense_map
