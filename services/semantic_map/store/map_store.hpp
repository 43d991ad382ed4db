#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "services/semantic_map/store/file_watch.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace SQLite {
class Database;
class Statement;
}  // namespace SQLite

namespace curbstone::semantic_map::store {

/// The map file: SQLite, application id "CURB", schema version in PRAGMA user_version.
///
///   meta(key, value)                         epoch, tile_size, cell_size; superseded, while such a file is beside
///   tiles(x, y, utime, z_origin, cells)      cells: zlib of class[625], height[625] (int16, low bytes first, then
///                                            high bytes), cost[625],
///                                            min(255, 32 hits) - confidence mod 256[625], hits[625]
///   curbs(id, dropped, confidence, points, inferred)
///                                            points: float32 LE, 6 a vertex: x y z height high_side_x high_side_y
///   markings(id, type, confidence, width, dash, gap, points)  points: float32 LE, 4 a vertex: x y z painted (0 or 1)
///   trajectory(utime, revolution, x, y, z, qw, qx, qy, qz)    T_map_base at the end of each revolution
///
/// Schema 1 stored the plain confidence and no hits; schema 2 had no markings and no inferred curbs. Such maps can be
/// read, without these; writing to one makes it a map of schema 3.
///
/// The file contains no wall clock, pid or revision: two replays of one log give the same bytes.
inline constexpr std::int32_t kMapSchemaVersion = 3;

/// One line that names the file and the error.
class MapStoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Waiting does not help: another process writes the map, or the file is something else and has been named by mistake.
class WrongMapFile : public MapStoreError {
 public:
  using MapStoreError::MapStoreError;
};

/// It was a map, or the beginning of one: the disk has lost a part of it, as in a power cut.
class DamagedMapFile : public MapStoreError {
 public:
  using MapStoreError::MapStoreError;
};

/// Reads a map, also while a service writes it. Never changes the file. All functions throw MapStoreError.
class MapReader {
 public:
  /// Throws if the file is missing, is not a map, or has a newer schema.
  explicit MapReader(const std::string& path);
  ~MapReader();

  /// While this object lives, all reads see the file as it was at the first read, whatever a service writes meanwhile:
  /// the tiles and curbs are of one moment, and of one drive. The writer's journal grows during that time.
  class Moment {
   public:
    explicit Moment(const MapReader& reader);
    ~Moment();
    Moment(const Moment&) = delete;
    Moment& operator=(const Moment&) = delete;

   private:
    const MapReader& reader_;
  };

  /// Schema of the file: 1 .. kMapSchemaVersion.
  [[nodiscard]] std::int32_t schema() const;
  [[nodiscard]] std::int32_t epoch() const;
  [[nodiscard]] std::vector<tile::MapTile> tiles() const;  ///< by key
  [[nodiscard]] std::vector<TileKey> tile_keys() const;    ///< in order
  /// The tile as it is in the file now; nothing if there is none. Some 50 us.
  [[nodiscard]] std::optional<tile::MapTile> tile(TileKey key) const;
  [[nodiscard]] std::vector<tile::CurbLine> curbs() const;             ///< by id
  [[nodiscard]] std::vector<tile::MarkingLine> markings() const;       ///< by id
  [[nodiscard]] std::vector<tile::TrajectoryPose> trajectory() const;  ///< by utime
  /// PRAGMA integrity_check: "ok" or what is wrong.
  [[nodiscard]] std::string integrity() const;

 private:
  std::string path_;
  std::unique_ptr<SQLite::Database> db_;
  mutable std::unique_ptr<SQLite::Statement> one_tile_;  // prepared once
};

/// Writes a map. There is one writer per file: a second one is refused while the first lives. The lock ends with the
/// process, also after kill -9. Each write is one transaction: it takes effect as a whole or not at all.
class MapStore {
 public:
  /// Opens or creates the file, and converts a map of an earlier schema. Throws MapStoreError: not a map or a newer
  /// schema (the file is left untouched), another writer, no such directory, no permission.
  explicit MapStore(std::string path);
  ~MapStore();

  /// The changes of one transaction.
  struct Batch {
    bool clear = false;        ///< first discard everything stored: another drive begins
    std::string keep_in = {};  ///< copy the stored map to this file before that; empty: do not
    std::int32_t epoch = 0;
    std::vector<tile::MapTile> tiles = {};                     ///< replace those with the same key
    std::vector<tile::TrajectoryPose> trajectory = {};         ///< appended
    const std::vector<tile::CurbLine>* curbs = nullptr;        ///< replaces all curbs, if given
    const std::vector<tile::MarkingLine>* markings = nullptr;  ///< replaces all markings, if given
    /// Sets superseded(), the file that this map replaces once it is complete; "": none any more.
    std::optional<std::string> superseded = {};
  };
  /// Throws MapStoreError (disk full, I/O error): then nothing of the batch is in the file; try again later. If the
  /// file was deleted meanwhile, it is first written again with its content. Another file that was put in its place is
  /// renamed before that (set_replacement_aside()), unless another process writes it: then writing fails. If somebody
  /// wrote to the file, so that it is no longer this map, DamagedMapFile is thrown.
  void write(const Batch& batch);
  /// Why the file was written again, in words: each time since the last call.
  [[nodiscard]] std::vector<std::string> take_restored() { return std::exchange(restored_, {}); }

  /// Epoch, and utime of the first and the newest pose (0: none) in the file, to decide whether a drive continues it.
  [[nodiscard]] std::int32_t epoch() const { return epoch_; }
  [[nodiscard]] std::int64_t first_utime() const { return first_utime_; }
  [[nodiscard]] std::int64_t last_utime() const { return last_utime_; }
  /// Name of a new file for a drive that must make room for another: map.db -> map-20261123T165133Z.db, by the time of
  /// its first pose. If that name is taken, as on a vehicle whose clock restarts at each boot, ...-2.db.
  [[nodiscard]] std::string free_name() const;
  /// The file beside the map that a killed writer was going to remove, because this map replaces it; empty if none. It
  /// is always in the same folder and named as by free_name().
  [[nodiscard]] const std::string& superseded() const { return superseded_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// The drive is over: rewrites the file in canonical order, so that the same content is the same bytes, and closes
  /// it. Throws MapStoreError; the file is then as it was, complete.
  void close_canonical();

 private:
  struct Lock;
  void open();
  void heed_others();
  void restore();
  [[nodiscard]] std::string set_replacement_aside_unless_in_use() const;
  [[nodiscard]] bool is_still_this_map() const;
  void copy_to(const std::string& path);
  [[nodiscard]] std::string stored_superseded() const;

  std::string path_;
  std::unique_ptr<Lock> lock_;  // outlives db_: SQLite's own locks go when any descriptor of the file is closed
  std::unique_ptr<SQLite::Database> db_;
  std::int32_t epoch_ = 0;
  std::int64_t first_utime_ = 0;
  std::int64_t last_utime_ = 0;
  std::string superseded_;
  FileWatch watch_;
  std::vector<std::string> restored_;
};

}  // namespace curbstone::semantic_map::store
