#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/counters.hpp"
#include "services/semantic_map/map_store.hpp"

namespace curbstone {

/// Writes what changes to the map file, a transaction a second. While the disk is full (or fails) it keeps the newest
/// state of each tile in memory, up to a bound, says so, and writes when it can again.
class MapKeeper {
 public:
  /// Opens the file: throws MapStoreError. Empty path: keeps nothing.
  MapKeeper(const std::string& path, std::size_t max_pending_tiles);

  /// A drive begins (first pose, or a new epoch of the map). An earlier map of the same drive is gone on with (the
  /// service was restarted); any other is forgotten.
  void start(std::int32_t epoch, std::int64_t utime);
  void put(const MapTile& tile);
  void put(const TrajectoryPose& pose);
  /// All curbs of the map as they are now; they go with the next batch.
  void put(std::vector<CurbLine> curbs);
  /// Writes what is pending.
  void write();
  /// Writes the rest and the curbs, and closes the file in canonical form.
  void finish(std::vector<CurbLine> curbs);

  /// In words; empty when all is well.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void write_batch();
  std::unique_ptr<MapStore> store_;
  std::size_t max_pending_;
  std::int32_t epoch_ = 0;
  bool clear_ = false;
  std::unordered_map<TileKey, MapTile, TileKeyHash> tiles_;
  std::vector<TrajectoryPose> trajectory_;
  std::optional<std::vector<CurbLine>> curbs_;
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone
