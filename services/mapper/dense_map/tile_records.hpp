#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/packing/spill_file.hpp"
#include "common/tiles/tile.hpp"

namespace curbstone::mapper::dense_map {

/// Key of a place within a tile.
[[nodiscard]] inline std::uint64_t place_key(const TilePoint& point) {
  return (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.x)) << 32) |
         (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.y)) << 16) | static_cast<std::uint16_t>(point.z);
}

/// The content of a tile: the list of records that is published as MAP_POINTS (see common/tiles/tile.hpp), with time
/// and keyframe of each.
struct TileRecords {
  /// Records from `first` up to the next run share one anchor and came from `utime` (us) on.
  struct Run {
    std::int32_t anchor;
    std::int32_t first;
    std::int64_t utime;
    bool operator==(const Run&) const = default;
  };
  std::vector<TilePoint> records;
  std::vector<Run> runs;

  /// The number of the record after the last one of a run.
  [[nodiscard]] std::size_t end_of(std::size_t run) const {
    return run + 1 < runs.size() ? static_cast<std::size_t>(runs[run + 1].first) : records.size();
  }
  /// For each record, whether it is a point that has not been removed.
  [[nodiscard]] std::vector<bool> standing() const;
  /// These points, in order.
  [[nodiscard]] std::vector<TilePoint> points() const;
  bool operator==(const TileRecords&) const = default;
};

/// The records of a tile, packed, and in a file if there is one. Copies share the same data and may be read in any
/// thread.
class PackedRecords {
 public:
  PackedRecords() = default;  ///< of no tile
  PackedRecords(const TileRecords& records, SpillFile& file);

  [[nodiscard]] bool empty() const { return values_.empty(); }
  /// In memory in no form.
  [[nodiscard]] bool is_in_file() const { return values_.is_in_file(); }
  /// The unpacked records. Throws std::runtime_error if the file cannot be read.
  [[nodiscard]] TileRecords read() const;

 private:
  SpillFile::Values values_;
};

}  // namespace curbstone::mapper::dense_map
