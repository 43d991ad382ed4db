#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/semantic_map/store/earlier_drive.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::semantic_map::store {

/// The lines that a map file held.
struct StoredLines {
  tile::MapLines lines;
  std::unordered_set<TileKey, TileKeyHash> tiles;
};

/// What a map file that cannot be used does at the start.
enum class UnusableFile { kThrows, kWaits };

/// Writes changes to the map file, one transaction at a time, in another thread: the disk takes tens of ms, for which
/// no tile should wait. While the disk is full (or fails) it keeps the newest state of each tile in memory, up to a
/// bound (and as many again while a write is under way), reports the fault, and writes when it can again. Calls come
/// from one thread.
///
/// | state | event | next |
/// |---|---|---|
/// | kNoFile: nothing is stored | any | kNoFile |
/// | kIdle: the file may hold the drive of an earlier process | start() | kRecording |
/// | kRecording | start() of another drive: the stored one is moved aside (EarlierDrive) | kRecording |
/// | kIdle, kRecording | finish() | kClosed; unchanged if the file cannot be written |
/// | kClosed | any | kClosed |
///
/// Counters, of confirmed writes: store.transactions, store.tiles, faults.store; dropped.unstored_tiles,
/// dropped.unstored_poses; store.restored.
class MapKeeper {
 public:
  /// Opens the file: throws MapStoreError. Empty path: nothing is stored. `keep_earlier`: an earlier drive in the file
  /// is moved to a file beside it when another begins (MapStore::free_name). With UnusableFile::kWaits a damaged file
  /// is set aside with a fault (set_damaged_aside()), and another is begun. Any other file that cannot be used is a
  /// fault, and write() tries it again, unless it is a WrongMapFile.
  MapKeeper(const std::string& path, std::size_t max_pending_tiles, bool keep_earlier = true,
            UnusableFile unusable = UnusableFile::kThrows);
  /// Waits for the current transaction; pending changes are lost without finish().
  ~MapKeeper();
  MapKeeper(const MapKeeper&) = delete;
  MapKeeper& operator=(const MapKeeper&) = delete;

  /// Whether the map is stored in a file.
  [[nodiscard]] bool keeps() const { return state_ == State::kIdle || state_ == State::kRecording; }
  /// Begins a drive (first pose, or a new epoch of the map). If the file has the same drive (the service was
  /// restarted), it is continued. Any other drive is moved to a file beside it.
  void start(std::int32_t epoch, std::int64_t utime);
  /// Reports that the mapper has corrected the whole drive from `first_utime` on. If that is the drive that was moved
  /// aside, its file is removed when the drive is over, or when the next correction moves another aside; if the service
  /// dies before, its successor does so.
  void corrected_from(std::int64_t first_utime);
  void put(const tile::MapTile& tile);
  void put(const tile::TrajectoryPose& pose);
  /// Links all lines of the current map. The lines are written with the next batch; the function is called in the
  /// writing thread.
  using LinkLines = std::function<tile::MapLines()>;
  void put(LinkLines lines);
  /// The lines that the file had when start() continued its drive; otherwise nullptr.
  [[nodiscard]] std::shared_ptr<const StoredLines> previous_lines() const { return previous_lines_; }
  /// Duration of the last linking, us; 0: none yet.
  [[nodiscard]] std::int64_t linking_took() const { return linking_took_; }
  /// Starts to write pending changes, unless a transaction is under way.
  void write();
  /// Whether a transaction is under way, including the linking of its lines.
  [[nodiscard]] bool busy();
  /// Writes the remaining changes and the lines, and closes the file in canonical form.
  void finish(tile::MapLines lines);

  /// The error of the last transaction; or that the mapper began a new map in mid-drive, once the vehicle has driven
  /// for some seconds (of the poses' times) without a correction. Empty if there is no fault.
  [[nodiscard]] std::string fault() const;
  /// Whether the file lacks what is in memory because a write failed; after finish(): permanently.
  [[nodiscard]] bool failing() const { return !fault_.empty(); }
  /// Whether another file was begun in mid-drive since the last call, since the one that held the drive was damaged or
  /// overwritten: all tiles, poses and lines must be put once more.
  [[nodiscard]] bool take_lost() { return std::exchange(lost_, false); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class State { kNoFile, kIdle, kRecording, kClosed };
  /// Changes that the file lacks.
  struct Changes {
    bool clear = false;   // first discard all that is stored
    std::string keep_in;  // but copy it to this file before
    std::unordered_map<TileKey, tile::MapTile, TileKeyHash> tiles;
    std::vector<tile::TrajectoryPose> trajectory;
    LinkLines link_lines;
    std::optional<tile::MapLines> lines;
    std::int64_t linking_took = 0;  // us
    std::optional<std::string> superseded;
  };
  [[nodiscard]] bool has_store();
  void open_store();
  void note_error(const std::string& error);
  void begin_writing();
  void link_under_way();
  void await_writing();
  void take_back();
  void leave_damaged();
  void heed_restored();
  [[nodiscard]] std::shared_ptr<const StoredLines> read_lines() const;
  [[nodiscard]] bool continues_stored(std::int32_t epoch, std::int64_t utime) const;
  [[nodiscard]] std::string make_room(std::int64_t utime);
  void add(const tile::MapTile& tile);
  [[nodiscard]] MapStore::Batch batch_under_way() const;

  std::string path_;
  State state_ = State::kNoFile;
  std::unique_ptr<MapStore> store_;  // in kIdle and kRecording; nullptr while the file cannot be used
  std::shared_ptr<const StoredLines> previous_lines_;
  std::size_t max_pending_;
  bool keep_earlier_;
  UnusableFile unusable_;
  EarlierDrive earlier_;
  std::int32_t epoch_ = 0;
  std::int64_t newest_utime_ = 0;    // of a pose
  std::string restored_;             // why the file was written again
  std::int64_t restored_utime_ = 0;  // us, pose at that time; 0: never
  bool lost_ = false;
  Changes pending_;
  Changes under_way_;                 // must not be touched while it is written
  std::future<std::string> writing_;  // the error
  bool is_damaged_ = false;           // set by the thread that writes
  std::string fault_;
  std::string damaged_;  // file that was set aside
  std::int64_t linking_took_ = 0;
  Counters counters_;
};

}  // namespace curbstone::semantic_map::store
