#pragma once

#include <cstdint>
#include <vector>

#include "common/tile.hpp"

namespace curbstone {

/// A set of small numbers: open addressing, no erasing.
class NumberSet {
 public:
  [[nodiscard]] bool contains(std::uint32_t number) const;
  void insert(std::uint32_t number);
  void clear() { slots_ = {}, size_ = 0; }

 private:
  [[nodiscard]] std::size_t place_of(std::uint32_t number) const;
  std::vector<std::uint32_t> slots_;  // number + 1; 0 is free
  std::size_t size_ = 0;
};

/// One tile of the dense map: points that are only ever appended, at most one a voxel.
class DenseTile {
 public:
  /// `voxel_steps`: a voxel's side in kPositionStep; must divide kStepsPerTile.
  DenseTile(std::int32_t z_origin, int voxel_steps);

  /// m in map; a whole number.
  [[nodiscard]] std::int32_t z_origin() const { return z_origin_; }
  [[nodiscard]] const std::vector<TilePoint>& points() const { return points_; }

  /// Names the point's voxel within the tile.
  [[nodiscard]] std::uint32_t voxel_number(const TilePoint& point) const;
  [[nodiscard]] bool occupied(std::uint32_t voxel) const { return occupied_.contains(voxel); }
  /// The point's voxel must not be occupied. `utime`: of the revolution that settled the point; `anchor`: the node of
  /// the drive that the vehicle was at.
  void append(const TilePoint& point, std::int64_t utime, std::int32_t anchor);
  /// Points from `first` on, up to the next run, came from `utime` on with one anchor.
  struct Run {
    std::int32_t anchor;
    std::int32_t first;
    std::int64_t utime;
  };
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }
  /// Forgets the runs that began after `utime`. Returns how many points went.
  std::int64_t cut_after(std::int64_t utime);
  /// When the newest point came, us. A fact of the content: whenever and in how many messages it is sent.
  [[nodiscard]] std::int64_t utime() const { return utime_; }

  /// Lowest height seen in each 0.6 m column, m in map; +infinity where nothing was seen.
  static constexpr int kColumns = 5;
  [[nodiscard]] float& lowest(int column, int row);
  [[nodiscard]] float& lowest_at(const TilePoint& point) {
    return lowest(point.x * kColumns / kStepsPerTile, point.y * kColumns / kStepsPerTile);
  }

  /// Gives back the memory that only adding points needs; it is made again from the points when wanted.
  void sleep();
  void wake();
  [[nodiscard]] bool asleep() const { return asleep_; }

 private:
  std::int32_t z_origin_;
  int voxel_steps_;
  bool asleep_ = false;
  std::int64_t utime_ = 0;
  std::vector<TilePoint> points_;
  std::vector<Run> runs_;
  NumberSet occupied_;
  std::vector<float> lowest_;
};

}  // namespace curbstone
