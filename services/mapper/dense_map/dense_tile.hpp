#pragma once

#include <cstdint>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::mapper::dense_map {

/// A set of numbers below 2^31 - 1, each with a mark or without: open addressing.
class NumberSet {
 public:
  [[nodiscard]] bool contains(std::uint32_t number) const;
  [[nodiscard]] bool is_marked(std::uint32_t number) const;
  /// Nothing if it is in the set.
  void insert(std::uint32_t number, bool marked = false);
  /// Nothing if it is not in the set.
  void erase(std::uint32_t number);
  [[nodiscard]] std::size_t bytes() const { return slots_.capacity() * sizeof(std::uint32_t); }
  /// Asks memory for where a search for the number will begin.
  void prefetch(std::uint32_t number) const {
    if (!slots_.empty()) __builtin_prefetch(&slots_[home_of(number)]);
  }

 private:
  [[nodiscard]] std::size_t home_of(std::uint32_t number) const;
  [[nodiscard]] std::size_t place_of(std::uint32_t number) const;
  std::vector<std::uint32_t> slots_;  // number + 1, and the mark; 0 is free
  std::size_t size_ = 0;
};

/// One tile of the dense map: at most one point a voxel. What it keeps is the list of records that goes out as
/// MAP_POINTS (see common/tiles/tile.hpp): points, and what took some of them out again. It is only ever appended to.
class DenseTile {
 public:
  /// `voxel_steps`: a voxel's side in kPositionStep; must divide kStepsPerTile.
  DenseTile(std::int32_t z_origin, int voxel_steps);

  /// m in map; a whole number.
  [[nodiscard]] std::int32_t z_origin() const { return z_origin_; }
  [[nodiscard]] const std::vector<TilePoint>& records() const { return records_; }
  /// What is there: the records that are points and have not been taken out, in order.
  [[nodiscard]] std::vector<TilePoint> points() const;
  /// Of each record whether it is one of those.
  [[nodiscard]] std::vector<bool> standing() const;
  [[nodiscard]] std::size_t num_points() const { return records_.size() - 2 * num_removals_; }
  [[nodiscard]] std::size_t num_removals() const { return num_removals_; }

  /// Names the point's voxel within the tile.
  [[nodiscard]] std::uint32_t voxel_number(const TilePoint& point) const;
  [[nodiscard]] bool occupied(std::uint32_t voxel) const { return occupied_.contains(voxel); }
  /// occupied() will be asked for the voxel some points later.
  void prefetch(std::uint32_t voxel) const { occupied_.prefetch(voxel); }
  /// Whether the voxel is occupied, and was when the tile woke: by a visit before this one.
  [[nodiscard]] bool knew(std::uint32_t voxel) const { return has_slept_ && occupied_.is_marked(voxel); }
  [[nodiscard]] bool has_slept() const { return has_slept_; }
  /// The point's voxel must not be occupied. `utime`: of the scan that settled the point; `anchor`: the node of
  /// the drive that the vehicle was at.
  void append(const TilePoint& point, std::int64_t utime, std::int32_t anchor);
  /// Takes points out, by the numbers of their records, of which each must be there().
  void remove(const std::vector<std::uint32_t>& records, std::int64_t utime);
  /// Records from `first` on, up to the next run, came from `utime` on with one anchor.
  struct Run {
    std::int32_t anchor;
    std::int32_t first;
    std::int64_t utime;
  };
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }
  /// The number of the record after a run's last.
  [[nodiscard]] std::size_t end_of(std::size_t run) const {
    return run + 1 < runs_.size() ? static_cast<std::size_t>(runs_[run + 1].first) : records_.size();
  }
  /// Takes the records of a tile that was, as they are; for a tile that has none. Not `awake`: it sleeps.
  void restore(std::vector<TilePoint> records, std::vector<Run> runs, bool awake);
  /// Forgets the runs that began after `utime`: what they took out is there again.
  void cut_after(std::int64_t utime);
  /// When the newest point came, us. A fact of the content: whenever and in how many messages it is sent.
  [[nodiscard]] std::int64_t utime() const { return utime_; }

  /// Lowest height seen in each 0.6 m column, m in map; +infinity where nothing was seen.
  static constexpr int kColumns = 5;
  static constexpr double kColumnsPerMetre = kColumns / kTileSize;
  [[nodiscard]] float& lowest(int column, int row);
  [[nodiscard]] float& lowest_at(const TilePoint& point) {
    return lowest(point.x * kColumns / kStepsPerTile, point.y * kColumns / kStepsPerTile);
  }

  /// How often beams have lately been seen to pass through a point, by its record; kGone: it is not there. Forgotten in
  /// sleep.
  static constexpr std::uint8_t kGone = 255;
  [[nodiscard]] std::uint8_t& seen_through(std::size_t record) { return seen_through_[record]; }
  [[nodiscard]] bool there(std::size_t record) const { return seen_through_[record] != kGone; }
  /// Columns of 0.2 m above which something has been taken out. Forgotten in sleep.
  static constexpr int kVacatedColumns = 15;
  [[nodiscard]] bool vacated(int column) const {
    return !vacated_.empty() && vacated_[static_cast<std::size_t>(column)];
  }
  void set_vacated(int column);
  /// When points were taken out last, us.
  [[nodiscard]] std::int64_t removed_at() const { return removed_at_; }

  /// Gives back the memory that only adding points needs; it is made again from the points when wanted.
  void sleep();
  void wake();
  [[nodiscard]] bool asleep() const { return asleep_; }
  /// Memory that it has asked for, beside its own size.
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::int32_t z_origin_;
  int voxel_steps_;
  bool asleep_ = false;
  bool has_slept_ = false;
  std::int64_t utime_ = 0;
  void index_points();
  void append_record(const TilePoint& record, std::int64_t utime, std::int32_t anchor);
  std::int64_t removed_at_ = 0;
  std::size_t num_removals_ = 0;
  std::vector<TilePoint> records_;
  std::vector<Run> runs_;
  NumberSet occupied_;
  std::vector<float> lowest_;
  std::vector<std::uint8_t> seen_through_;
  std::vector<bool> vacated_;
};

}  // namespace curbstone::mapper::dense_map
