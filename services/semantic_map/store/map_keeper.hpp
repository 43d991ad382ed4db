#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::semantic_map::store {

/// What a map file held.
struct StoredLines {
  tile::MapLines lines;
  std::unordered_set<TileKey, TileKeyHash> tiles;
};

/// Writes what changes to the map file, a transaction at a time, in another thread: the disk takes tens of ms, for
/// which no tile should wait. While the disk is full (or fails) it keeps the newest state of each tile in memory, up to
/// a bound (and as many again while it tries), says so, and writes when it can again. One thread calls.
///
/// Counters, of what is known to be written: store.transactions, store.tiles, faults.store; dropped.unstored_tiles,
/// dropped.unstored_poses.
class MapKeeper {
 public:
  /// Opens the file: throws MapStoreError. Empty path: keeps nothing. `keep_earlier`: a drive that must make room for
  /// another is kept in a file beside (MapStore::free_name).
  MapKeeper(const std::string& path, std::size_t max_pending_tiles, bool keep_earlier = true);
  /// Waits for what is under way; what is pending is lost without finish().
  ~MapKeeper();
  MapKeeper(const MapKeeper&) = delete;
  MapKeeper& operator=(const MapKeeper&) = delete;

  /// Whether there is a file to keep the map in.
  [[nodiscard]] bool keeps() const { return store_ != nullptr; }
  /// A drive begins (first pose, or a new epoch of the map). An earlier map of the same drive is gone on with (the
  /// service was restarted). Any other makes room, and is kept in a file beside.
  void start(std::int32_t epoch, std::int64_t utime);
  /// The mapper has corrected the drive as a whole, from `first_utime` on: if that is the drive that made room, its
  /// file beside is removed when the drive is over, or when the next correction makes another; also by the service's
  /// successor, if it dies before.
  void corrected_from(std::int64_t first_utime);
  void put(const tile::MapTile& tile);
  void put(const tile::TrajectoryPose& pose);
  /// Links all lines of the map as they are now. They go with the next batch; it is called in the thread that writes.
  using LinkLines = std::function<tile::MapLines()>;
  void put(LinkLines lines);
  /// Of the file, when this process went on with its drive (start()): its predecessor's. Else nullptr.
  [[nodiscard]] std::shared_ptr<const StoredLines> lines_before() const { return lines_before_; }
  /// How long that took at last, us; 0: not yet.
  [[nodiscard]] std::int64_t linking_took() const { return linking_took_; }
  /// Begins to write what is pending, unless the last transaction is still under way.
  void write();
  /// Whether it is, lines that are linked for it included.
  [[nodiscard]] bool busy();
  /// Writes the rest and the lines, and closes the file in canonical form.
  void finish(tile::MapLines lines);

  /// What became of the last transaction, in words; or that the map was begun anew in mid-drive, once the vehicle has
  /// driven for some seconds (of the poses' times) and no correction was heard. Empty when all is well.
  [[nodiscard]] std::string fault() const;
  /// Whether the file lacks what is in memory, because it could not be written; after finish(): for good.
  [[nodiscard]] bool failing() const { return !fault_.empty(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// What the file does not know yet.
  struct Changes {
    bool clear = false;   // first of all that was stored
    std::string keep_in;  // but in this file
    std::unordered_map<TileKey, tile::MapTile, TileKeyHash> tiles;
    std::vector<tile::TrajectoryPose> trajectory;
    LinkLines link_lines;
    std::optional<tile::MapLines> lines;
    std::int64_t linking_took = 0;  // us
    std::optional<std::string> superseded;
  };
  void begin_writing();
  void link_under_way();
  void await_writing();
  void take_back();
  [[nodiscard]] std::shared_ptr<const StoredLines> read_lines() const;
  [[nodiscard]] std::string make_room(std::int64_t utime);
  void remove_superseded();
  void add(const tile::MapTile& tile);
  [[nodiscard]] MapStore::Batch batch_under_way() const;

  std::string path_;
  std::unique_ptr<MapStore> store_;
  std::shared_ptr<const StoredLines> lines_before_;
  /// The drive that made room, while this process ran.
  struct Earlier {
    std::string file;
    std::int64_t first_utime = 0;
    std::int64_t made_room = 0;  // utime
  };
  std::size_t max_pending_;
  bool keep_earlier_;
  bool has_begun_ = false;
  std::optional<Earlier> earlier_;
  std::string superseded_;  // file of this drive, before it was corrected: until all tiles have come again
  std::int32_t epoch_ = 0;
  std::int64_t newest_utime_ = 0;  // of a pose
  Changes pending_;
  Changes under_way_;                 // not touched while it is written
  std::future<std::string> writing_;  // what went wrong
  std::string fault_;
  std::int64_t linking_took_ = 0;
  Counters counters_;
};

}  // namespace curbstone::semantic_map::store
