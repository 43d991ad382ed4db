#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/tile_records.hpp"

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

/// One tile of the dense map: at most one point a voxel. What it keeps are its TileRecords, which are only ever
/// appended to. Awake it has indexes beside them, by which points are added and taken out. Asleep it has the records
/// alone, and those may be put away, out of memory: whoever looks at them calls read().
class DenseTile {
 public:
  using Run = TileRecords::Run;

  /// `voxel_steps`: a voxel's side in kPositionStep; must divide kStepsPerTile.
  DenseTile(std::int32_t z_origin, int voxel_steps);

  /// m in map; a whole number.
  [[nodiscard]] std::int32_t z_origin() const { return z_origin_; }
  /// For a look at its records. Where they are in memory these are they, until the tile changes. Of a tile that is away
  /// they are read from the file and unpacked, anew with each call, and the copy is the caller's. Null if the file does
  /// not give them back.
  [[nodiscard]] std::shared_ptr<const TileRecords> read() const;
  [[nodiscard]] std::size_t num_records() const { return is_away_ ? num_packed_ : content_.records.size(); }
  /// What is there: the records that are points and have not been taken out.
  [[nodiscard]] std::size_t num_points() const { return num_records() - 2 * num_removals_; }
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
  /// Takes the records of a tile that was, as they are; for a tile that has none, awake or asleep.
  void restore(TileRecords records);
  /// Forgets the runs that began after `utime`: what they took out is there again. A tile that is away is read only if
  /// it has such runs, and is in memory then. False if the file does not give it back.
  [[nodiscard]] bool cut_after(std::int64_t utime);
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
  [[nodiscard]] bool asleep() const { return asleep_; }
  /// Takes the records of a tile that sleeps out of memory. False if there is nothing to take: it is awake, away or
  /// empty.
  bool put_away(SpillFile& file);
  [[nodiscard]] bool is_away() const { return is_away_; }
  /// Away, and not in memory in any form.
  [[nodiscard]] bool is_in_file() const { return is_away_ && packed_.is_in_file(); }
  /// With its records. False if the file does not give them back: then it is away as before, and is not tried again
  /// before try_again().
  [[nodiscard]] bool wake();
  void try_again() { is_refused_ = false; }
  /// PackedRecords of a tile that is away.
  [[nodiscard]] const PackedRecords& packed() const { return packed_; }
  /// Memory that it has asked for, beside its own size and what is away.
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::int32_t z_origin_;
  int voxel_steps_;
  bool asleep_ = false;
  bool has_slept_ = false;
  bool is_away_ = false;
  bool is_refused_ = false;  // by the file
  std::int64_t utime_ = 0;
  std::int64_t newest_run_ = 0;  // us
  void index_points();
  void append_record(const TilePoint& record, std::int64_t utime, std::int32_t anchor);
  [[nodiscard]] bool bring_back();
  std::int64_t removed_at_ = 0;
  std::size_t num_removals_ = 0;
  TileRecords content_;         // empty while it is away
  PackedRecords packed_;        // its first records, if not empty: all of them while it is away
  std::size_t num_packed_ = 0;  // records
  NumberSet occupied_;
  std::vector<float> lowest_;
  std::vector<std::uint8_t> seen_through_;
  std::vector<bool> vacated_;
};

}  // namespace curbstone::mapper::dense_map
