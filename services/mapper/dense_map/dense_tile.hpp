#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/tile_records.hpp"

namespace curbstone::mapper::dense_map {

/// A set of numbers below 2^31 - 1, each with an optional mark: open addressing.
class NumberSet {
 public:
  [[nodiscard]] bool contains(std::uint32_t number) const;
  [[nodiscard]] bool is_marked(std::uint32_t number) const;
  /// Makes room for this many numbers.
  void reserve(std::size_t size);
  /// Does nothing if the number is in the set.
  void insert(std::uint32_t number, bool marked = false);
  /// Does nothing if the number is not in the set.
  void erase(std::uint32_t number);
  [[nodiscard]] std::size_t bytes() const { return slots_.capacity() * sizeof(std::uint32_t); }
  /// The slot at which a search for the number begins, to be prefetched; nullptr if there is none.
  [[nodiscard]] const void* begin_of_search(std::uint32_t number) const {
    return slots_.empty() ? nullptr : &slots_[home_of(number)];
  }

 private:
  [[nodiscard]] std::size_t home_of(std::uint32_t number) const;
  [[nodiscard]] std::size_t place_of(std::uint32_t number) const;
  void grow(std::size_t capacity);
  std::vector<std::uint32_t> slots_;  // number + 1, and the mark; 0 is unused
  std::size_t size_ = 0;
};

/// One tile of the dense map, with at most one point per voxel. Its content is its TileRecords, an append-only list. An
/// awake tile also has indexes, for adding and removing points. A sleeping tile has the records alone, and these may be
/// spilled to a file: read() gives access to them in every state.
class DenseTile {
 public:
  using Run = TileRecords::Run;

  /// `voxel_steps`: a voxel's side in kPositionStep; must divide kStepsPerTile.
  DenseTile(std::int32_t z_origin, int voxel_steps);

  /// m in map; a whole number.
  [[nodiscard]] std::int32_t z_origin() const { return z_origin_; }
  /// The records, for reading. If they are in memory the pointer refers to them, and is valid until the tile changes.
  /// If they are spilled, each call reads them from the file and unpacks them, and the caller owns the copy. Null if
  /// the file cannot be read.
  [[nodiscard]] std::shared_ptr<const TileRecords> read() const;
  [[nodiscard]] std::size_t num_records() const { return is_spilled_ ? num_packed_ : content_.records.size(); }
  /// Number of points in the tile: those that were added and not removed.
  [[nodiscard]] std::size_t num_points() const { return num_records() - 2 * num_removals_; }
  [[nodiscard]] std::size_t num_removals() const { return num_removals_; }

  /// The number of the point's voxel within the tile.
  [[nodiscard]] std::uint32_t voxel_number(const TilePoint& point) const {
    const auto layer = static_cast<std::uint32_t>(voxels_in(point.z + floor_steps_));
    const auto per_side = static_cast<std::uint32_t>(per_side_);
    return (layer * per_side + voxels_in(point.y)) * per_side + voxels_in(point.x);
  }
  [[nodiscard]] bool occupied(std::uint32_t voxel) const { return occupied_.contains(voxel); }
  /// What occupied() reads first, to be prefetched.
  [[nodiscard]] const void* begin_of_search(std::uint32_t voxel) const { return occupied_.begin_of_search(voxel); }
  /// Whether the voxel is occupied, and already was when the tile woke: by an earlier visit.
  [[nodiscard]] bool was_occupied(std::uint32_t voxel) const { return has_slept_ && occupied_.is_marked(voxel); }
  [[nodiscard]] bool has_slept() const { return has_slept_; }
  /// Adds a point; its voxel must not be occupied. `utime`: us, of the scan in which the point settled; `anchor`: the
  /// keyframe at the vehicle then.
  void append(const TilePoint& point, std::int64_t utime, std::int32_t anchor);
  /// Removes points by the numbers of their records; each of them must be there().
  void remove(const std::vector<std::uint32_t>& records, std::int64_t utime);
  /// Sets the records of an empty tile, awake or asleep.
  void restore(TileRecords records);
  /// Discards the runs that began after `utime`, us: the points that they removed are restored. A spilled tile is read
  /// only if it has such runs, and stays in memory then. False if the file cannot be read.
  [[nodiscard]] bool truncate_after(std::int64_t utime);
  /// Stamp of the newest point, us. It depends on the content alone, not on when or in how many messages it is sent.
  [[nodiscard]] std::int64_t utime() const { return utime_; }

  /// Lowest height seen in each 0.6 m column, m in map; +infinity if nothing was seen.
  static constexpr int kColumns = 5;
  static constexpr double kColumnsPerMetre = kColumns / kTileSize;
  [[nodiscard]] float& lowest(int column, int row);
  [[nodiscard]] float& lowest_at(const TilePoint& point) {
    return lowest(point.x * kColumns / kStepsPerTile, point.y * kColumns / kStepsPerTile);
  }

  /// Number of recent scans whose beams passed through a point, by its record; kRemoved: the point is not there.
  /// Discarded in sleep.
  static constexpr std::uint8_t kRemoved = 255;
  [[nodiscard]] std::uint8_t& num_passes(std::size_t record) { return num_passes_[record]; }
  [[nodiscard]] bool is_present(std::size_t record) const { return num_passes_[record] != kRemoved; }
  /// Columns of 0.2 m above which something was removed. Discarded in sleep.
  static constexpr int kVacatedColumns = 15;
  [[nodiscard]] bool vacated(int column) const {
    return !vacated_.empty() && vacated_[static_cast<std::size_t>(column)];
  }
  [[nodiscard]] bool any_vacated() const { return !vacated_.empty(); }
  void set_vacated(int column);
  /// Number of scans whose beams passed through something above a column of 0.2 m. Discarded in sleep.
  [[nodiscard]] int scans_through(std::size_t column) const {
    return scans_through_.empty() ? 0 : scans_through_[column];
  }
  void set_scans_through(std::size_t column, int scans);
  /// Time of the scan with which a point clear of the ground was last added, us; 0: none was.
  [[nodiscard]] std::int64_t raised_at() const { return raised_at_; }
  void set_raised_at(std::int64_t utime) { raised_at_ = utime; }
  /// Time of the last removal, us.
  [[nodiscard]] std::int64_t removed_at() const { return removed_at_; }

  /// Frees the indexes; wake() rebuilds them from the records.
  void sleep();
  [[nodiscard]] bool asleep() const { return asleep_; }
  /// Spills the records of a sleeping tile. False if there is nothing to spill: the tile is awake, spilled already or
  /// empty.
  bool spill(SpillFile& file);
  [[nodiscard]] bool is_spilled() const { return is_spilled_; }
  /// Spilled, and in memory in no form.
  [[nodiscard]] bool is_in_file() const { return is_spilled_ && packed_.is_in_file(); }
  /// Reads the records back if necessary and builds the indexes. False if the file cannot be read: the tile stays
  /// spilled, and wake() does not read again before try_again().
  [[nodiscard]] bool wake();
  void allow_retry() { read_failed_ = false; }
  /// The packed records of a spilled tile.
  [[nodiscard]] const PackedRecords& packed() const { return packed_; }
  /// Memory that the tile has allocated, without its own size and what is spilled, in bytes.
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// steps / voxel_steps, exact for 0 <= steps < 2^17 and voxel_steps < 2^11: a division takes the CPU ten times
  /// longer.
  [[nodiscard]] std::uint32_t voxels_in(int steps) const {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(steps) * inverse_) >> 32);
  }

  std::int32_t z_origin_;
  std::int32_t per_side_;     // voxels along a tile's side
  std::int32_t floor_steps_;  // below every int16, on the lattice through 0
  std::uint64_t inverse_;     // 2^32 / voxel_steps, rounded up
  bool asleep_ = false;
  bool has_slept_ = false;
  bool is_spilled_ = false;
  bool read_failed_ = false;  // the file could not be read
  std::int64_t utime_ = 0;
  std::int64_t newest_run_ = 0;  // us
  void index_points();
  void append_record(const TilePoint& record, std::int64_t utime, std::int32_t anchor);
  [[nodiscard]] bool unspill();
  std::int64_t raised_at_ = 0;
  std::int64_t removed_at_ = 0;
  std::size_t num_removals_ = 0;
  TileRecords content_;         // empty while spilled
  PackedRecords packed_;        // of the first records, or empty; of all records while spilled
  std::size_t num_packed_ = 0;  // records
  NumberSet occupied_;
  std::vector<float> lowest_;
  std::vector<std::uint8_t> num_passes_;
  std::vector<bool> vacated_;
  std::vector<std::uint8_t> scans_through_;
};

}  // namespace curbstone::mapper::dense_map
