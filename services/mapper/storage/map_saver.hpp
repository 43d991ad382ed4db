#pragma once

#include <filesystem>
#include <future>
#include <string>

#include "common/bus/counters.hpp"
#include "services/mapper/storage/map_snapshot.hpp"

namespace curbstone::mapper::storage {

/// Writes a map to its folder again and again, beside its owner: only files that are not there yet, and so that the
/// folder holds a whole map at any time (save_map()). What cannot be written is counted and said; the next time all of
/// it is tried anew. One thread calls; the writing is in another.
///
/// Counters: folder.saved, faults.folder.
class MapSaver {
 public:
  explicit MapSaver(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Waits for what is under way.
  ~MapSaver() { finish(); }
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  /// Whether a snapshot is still being written.
  [[nodiscard]] bool busy();
  /// What the folder holds; nothing is known of it before the first snapshot. Not while busy.
  [[nodiscard]] const MapVersions& on_disk() const { return on_disk_; }
  /// Takes what was made against on_disk(); one that has nothing new is not written. Not while busy.
  void begin(MapSnapshot snapshot);
  /// Waits until it is written.
  void finish();

  /// Why the last snapshot could not be written; empty if it was.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  std::filesystem::path folder_;
  MapVersions on_disk_;
  MapVersions under_way_;
  std::future<std::string> writing_;  // what went wrong
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone::mapper::storage
