#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/dense_map/unreadable_tiles.hpp"
#include "services/mapper/journal/journal_lock.hpp"
#include "services/mapper/journal/journal_writer.hpp"
#include "services/mapper/journal/local_map_journal.hpp"
#include "services/mapper/journal/pose_thinning.hpp"
#include "services/mapper/journal/recorded_drive.hpp"
#include "services/mapper/pose_graph/atlas.hpp"

namespace curbstone::mapper::journal {

/// Records what another mapper needs to continue this drive. Each call copies a part of what the map has and the file
/// lacks: at most kBatchBytes, and nothing while the disk is busy. What has not been copied stays in the map itself. A
/// journal that cannot be written is restarted after a minute, or when the disk has room again. Calls come from one
/// thread.
class DriveJournal {
 public:
  /// `config_hash`: a mapper with another hash must not continue the drive. Throws JournalError if another process
  /// holds the journal.
  DriveJournal(const std::string& path, std::size_t max_bytes, std::string config_hash)
      : lock_(path),
        writer_(path, max_bytes),
        local_map_(path + ".local_map", config_hash),
        config_hash_(std::move(config_hash)) {}

  /// Begins a new epoch, in which every tile may differ. `drive`: the poses so far. The journal of the previous epoch
  /// stays until the new one has as much.
  void start_epoch(std::int32_t epoch, std::vector<RecordedPose> drive);
  /// The journal that is there is of this drive, which another mapper began: its age shows whether this one lives,
  /// until the journal of the first epoch has as much.
  void adopt(const RecordedDrive& drive);
  /// Begins the first epoch after adopt() in the adopted file: what that holds is not written again, so a mapper that
  /// is killed at once has lost nothing. False, and nothing is done, if the map is not that of the file: then
  /// start_epoch(). `until`: us, the last pose of the file that counts; the map may have grown since.
  [[nodiscard]] bool continue_epoch(std::int32_t epoch, std::int64_t until, const dense_map::DenseMap& map,
                                    const pose_graph::Atlas& atlas);
  /// Keeps an adopted journal young before the first epoch. `now`: us.
  void wait(std::int64_t now);
  /// Whether start_epoch() should restart the journal: writing failed a minute ago; or it failed for lack of space,
  /// which there is again; or half of the file belongs to evicted tiles. `now`: us.
  [[nodiscard]] bool needs_restart(std::int64_t now) const;
  /// Adds the pose of the vehicle, after the map has taken the scan. See PoseThinning.
  void add(const RecordedPose& pose);
  /// Sets the intensity scale of what the tiles take from now on.
  void set_rings(const intensity::RingHistograms& rings);
  /// Writes what the map has and the file lacks. `changed`: tiles that may have grown; `evicted`: tiles that are gone;
  /// `now`: us.
  void write(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas, const std::vector<TileKey>& changed,
             const std::vector<TileKey>& evicted, std::int64_t now);
  /// The journal of the map that scans are registered to, in a file beside this one.
  [[nodiscard]] LocalMapJournal& local_map() { return local_map_; }
  /// Deletes the journal: the drive is over, and nobody continues it. Waits for the disk.
  void remove() {
    writer_.remove();
    local_map_.remove();
  }

  /// Empty if there is no fault.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  static constexpr std::size_t kBatchBytes = 256 * 1024;  // copied in a millisecond
  struct Written {
    std::size_t records = 0;
    std::size_t runs = 0;
    std::size_t bytes = 0;
  };
  void begin(std::string& items, const dense_map::DenseMap& map, const pose_graph::Atlas& atlas);
  [[nodiscard]] std::string new_items(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas, std::int64_t now);
  [[nodiscard]] bool is_complete(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas) const;
  void give_up(std::int64_t now, const std::string& why);

  JournalLock lock_;
  JournalWriter writer_;
  LocalMapJournal local_map_;
  std::string config_hash_;
  std::int32_t epoch_ = 0;
  bool is_adopted_ = false;
  bool begins_ = false;     // a new file, with the next batch
  bool continues_ = false;  // the adopted file, likewise
  std::size_t adopted_bytes_ = 0;
  std::int64_t until_ = 0;     // us, the last pose of the adopted file that counts
  std::int64_t failed_ = 0;    // us; 0: no failure
  std::int64_t appended_ = 0;  // us
  std::string fault_;
  // What the file lacks.
  std::vector<RecordedPose> poses_;
  std::set<TileKey> changed_;
  dense_map::UnreadableTiles unreadable_;  // a journal without them is complete
  intensity::RingHistograms rings_;
  bool new_rings_ = false;
  std::vector<TileKey> evicted_;
  // What the file has.
  PoseThinning thinning_;
  int nodes_ = 0;
  std::size_t edges_ = 0;
  std::unordered_map<TileKey, Written, TileKeyHash> tiles_;
  std::size_t evicted_bytes_ = 0;  // bytes
};

}  // namespace curbstone::mapper::journal
