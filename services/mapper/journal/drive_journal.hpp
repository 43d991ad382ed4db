#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/journal/journal_lock.hpp"
#include "services/mapper/journal/journal_writer.hpp"
#include "services/mapper/journal/pose_thinning.hpp"
#include "services/mapper/journal/recorded_drive.hpp"
#include "services/mapper/pose_graph/atlas.hpp"

namespace curbstone::mapper::journal {

/// Keeps what a mapper would need that goes on with this drive. Each call copies some of what the map has and the file
/// has not, at most kBatchBytes and nothing while the disk is busy; what waits, waits in the map itself. A journal
/// that cannot be written is begun anew after a minute, or when the disk has room again. One thread calls.
class DriveJournal {
 public:
  /// `config_hash`: who has another is not to go on with it. Throws JournalError if another process keeps it.
  DriveJournal(const std::string& path, std::size_t max_bytes, std::string config_hash)
      : lock_(path), writer_(path, max_bytes), config_hash_(std::move(config_hash)) {}

  /// A new epoch: every tile may be another. `drive`: until now. The journal of the epoch before stays until this one's
  /// tells as much.
  void start_epoch(std::int32_t epoch, std::vector<RecordedPose> drive);
  /// Its writing failed a minute ago, or for want of room, which there is again; or half of the file is of tiles that
  /// are gone: it is begun anew by start_epoch(). `now`: us.
  [[nodiscard]] bool wants_anew(std::int64_t now) const;
  /// Where the vehicle is, after a scan that the map has taken. See PoseThinning.
  void add(const RecordedPose& pose);
  /// The scale of what the tiles take from now on.
  void set_rings(const intensity::RingHistograms& rings);
  /// What the map has more than the file. `changed`: tiles that may have grown; `evicted`: that are gone; `now`: us.
  void write(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas, const std::vector<TileKey>& changed,
             const std::vector<TileKey>& evicted, std::int64_t now);
  /// The drive is over, and nobody goes on with it. Waits for the disk.
  void remove() { writer_.remove(); }

  /// Empty when all is well.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  static constexpr std::size_t kBatchBytes = 256 * 1024;  // copied in a millisecond
  struct Written {
    std::size_t records = 0;
    std::size_t runs = 0;
    std::size_t bytes = 0;
  };
  void begin(std::string& items, const dense_map::DenseMap& map, const pose_graph::Atlas& atlas);
  [[nodiscard]] std::string new_items(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas);
  [[nodiscard]] bool is_complete(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas) const;
  void give_up(std::int64_t now, const std::string& why);

  JournalLock lock_;
  JournalWriter writer_;
  std::string config_hash_;
  std::int32_t epoch_ = 0;
  bool begins_ = false;        // with the next batch
  std::int64_t failed_ = 0;    // us; 0: it did not
  std::int64_t appended_ = 0;  // us
  std::string fault_;
  // What the file does not have yet.
  std::vector<RecordedPose> poses_;
  std::set<TileKey> changed_;
  intensity::RingHistograms rings_;
  bool new_rings_ = false;
  std::vector<TileKey> evicted_;
  // What it has.
  PoseThinning thinning_;
  int nodes_ = 0;
  std::size_t edges_ = 0;
  std::unordered_map<TileKey, Written, TileKeyHash> tiles_;
  std::size_t of_gone_tiles_ = 0;  // bytes
};

}  // namespace curbstone::mapper::journal
