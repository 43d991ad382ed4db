#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <utility>

#include "common/bus/counters.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_snapshot.hpp"

namespace curbstone::mapper::storage {

/// Saves a map to its folder repeatedly, in a thread of its own. Only files that the folder lacks are written, and the
/// folder holds a complete map at any time (save_map()). A failed save is counted and reported, and the next save
/// writes everything again. Tiles and scans that the file of far tiles cannot return are counted and reported too; the
/// rest is saved. Call it from one thread.
///
/// Counters: folder.saved, folder.left_out (tiles and scans of keyframes), faults.folder.
class MapSaver {
 public:
  explicit MapSaver(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Waits for the save in progress.
  ~MapSaver() { finish(); }
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  /// Whether a snapshot is still being written.
  [[nodiscard]] bool busy();
  /// The folder holds a loaded map, of which the files listed in `versions` need not be written again. Call it before
  /// the first snapshot, which is then written even if it contains nothing new.
  void set_on_disk(MapVersions versions) {
    on_disk_ = std::move(versions);
    is_of_loaded_map_ = true;
  }
  /// What the folder holds; empty before the first snapshot, unless holds() was called. Not while busy.
  [[nodiscard]] const MapVersions& on_disk() const { return on_disk_; }
  /// Begins to save a snapshot that was taken against on_disk(). A snapshot with nothing new is not written. Not while
  /// busy.
  void begin(MapSnapshot snapshot);
  /// Begins to save the last snapshot of a drive that a new drive follows. The folder is then renamed to the returned
  /// path, which has the UTC of `began`, us, in its name. If the snapshot cannot be written, the folder is renamed as
  /// it is. Not while busy.
  std::filesystem::path set_aside(MapSnapshot last, std::int64_t began);
  /// Waits until the snapshot is written.
  void finish();

  /// The fault of the last snapshot, which could not be written, or only in part; empty: none.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  std::filesystem::path folder_;
  MapVersions on_disk_;
  MapVersions under_way_;
  struct Result {
    std::string fault;  // why nothing was written; empty: the snapshot was written
    MissingParts missing;
  };
  void forget(const MissingParts& missing);
  bool is_of_loaded_map_ = false;  // the folder's head names the epoch of a loaded map
  bool is_last_ = false;           // the folder is set aside after the save in progress
  std::future<Result> writing_;
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone::mapper::storage
