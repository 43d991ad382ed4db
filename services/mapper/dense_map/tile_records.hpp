#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/packing/spill_file.hpp"
#include "common/tiles/tile.hpp"

namespace curbstone::mapper::dense_map {

/// Names a place in a tile.
[[nodiscard]] inline std::uint64_t place_key(const TilePoint& point) {
  return (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.x)) << 32) |
         (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.y)) << 16) | static_cast<std::uint16_t>(point.z);
}

/// What a tile is made of: the list of records that goes out as MAP_POINTS (see common/tiles/tile.hpp), and who made
/// which of them.
struct TileRecords {
  /// Records from `first` on, up to the next run, came from `utime` on with one anchor.
  struct Run {
    std::int32_t anchor;
    std::int32_t first;
    std::int64_t utime;
    bool operator==(const Run&) const = default;
  };
  std::vector<TilePoint> records;
  std::vector<Run> runs;

  /// The number of the record after a run's last.
  [[nodiscard]] std::size_t end_of(std::size_t run) const {
    return run + 1 < runs.size() ? static_cast<std::size_t>(runs[run + 1].first) : records.size();
  }
  /// Of each record whether it is a point and has not been taken out.
  [[nodiscard]] std::vector<bool> standing() const;
  /// Those, in order.
  [[nodiscard]] std::vector<TilePoint> points() const;
  bool operator==(const TileRecords&) const = default;
};

/// A tile's records that have been put away: packed, and in a file where there is one. Copies are of the same ones, and
/// may be read in any thread.
class PackedRecords {
 public:
  PackedRecords() = default;  ///< of no tile
  PackedRecords(const TileRecords& records, SpillFile& file);

  [[nodiscard]] bool empty() const { return values_.empty(); }
  /// Not in memory any more.
  [[nodiscard]] bool is_in_file() const { return values_.is_in_file(); }
  /// As they were. Throws std::runtime_error if the file cannot be read.
  [[nodiscard]] TileRecords read() const;

 private:
  SpillFile::Values values_;
};

}  // namespace curbstone::mapper::dense_map
