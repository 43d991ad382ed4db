#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <optional>
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
  /// `save_every`: s of message time between two periodic snapshots; 0: none.
  explicit MapSaver(std::filesystem::path folder, double save_every = 0)
      : folder_(std::move(folder)), save_every_(save_every) {}
  /// Waits for the save in progress.
  ~MapSaver() { finish(); }
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  /// Whether a snapshot is still being written.
  [[nodiscard]] bool busy();
  /// The folder holds a loaded map, whose files are listed in `versions`. It does not change, so they need not be
  /// written again in the epoch that begins next. Call it before the first snapshot, which is then written even if it
  /// contains nothing new.
  void set_loaded(MapVersions versions) { loaded_ = std::move(versions); }
  /// The map of this epoch is saved from now on.
  void begin_epoch(std::int32_t epoch);
  /// Whether the next periodic snapshot should be saved: `save_every` has passed by `utime`, us of message time, and no
  /// snapshot is being written. The first call starts the period.
  [[nodiscard]] bool is_due(std::int64_t utime);
  /// The next period begins at `utime`, us.
  void schedule_after(std::int64_t utime) { period_began_ = utime; }
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
  double save_every_;                  // s
  std::int64_t period_began_ = 0;      // us, message time; 0: no period has begun
  std::optional<MapVersions> loaded_;  // what the folder of the loaded map holds, until the first epoch
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
