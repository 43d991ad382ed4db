#include "services/semantic_map/map_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "services/semantic_map/map_store_blobs.hpp"
#include "services/semantic_map/sqlite.hpp"

namespace curbstone {

namespace {

constexpr std::int32_t kApplicationId = 0x43555242;  // "CURB"

constexpr const char* kSchema = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE tiles(x INTEGER, y INTEGER, utime INTEGER NOT NULL, z_origin REAL NOT NULL, cells BLOB NOT NULL,
                   PRIMARY KEY(x, y)) WITHOUT ROWID;
CREATE TABLE curbs(id INTEGER PRIMARY KEY, dropped INTEGER NOT NULL, confidence REAL NOT NULL, points BLOB NOT NULL);
CREATE TABLE trajectory(utime INTEGER PRIMARY KEY, revolution INTEGER NOT NULL, x REAL NOT NULL, y REAL NOT NULL,
                        z REAL NOT NULL, qw REAL NOT NULL, qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL);
INSERT INTO meta VALUES('tile_size', 3.0), ('cell_size', 0.12), ('epoch', 0);
)";

/// Runs `work`; what SQLite says becomes one line that names the file.
template <class Work>
auto for_file(const std::string& path, Work work) {
  try {
    return work();
  } catch (const SqliteError& error) {
    std::string hint;
    if (error.code == SQLITE_NOTADB) hint = " (not a curbstone map)";
    if (error.code == SQLITE_CORRUPT) hint = " (damaged: move it away, or mend it with 'sqlite3 FILE .recover')";
    if (error.code == SQLITE_FULL) hint = " (no room on the disk)";
    throw MapStoreError(fmt::format("{}: {}{}", path, error.what(), hint));
  }
}

/// Throws unless the file is a map of a schema that we know.
void check_identity(Sqlite& db, const std::string& path) {
  if (db.integer("PRAGMA application_id") != kApplicationId)
    throw MapStoreError(fmt::format("{}: is an SQLite file but not a curbstone map", path));
  const std::int64_t version = db.integer("PRAGMA user_version");
  if (version > kMapSchemaVersion)
    throw MapStoreError(fmt::format("{}: map schema {} is newer than this program's {}: use a newer curbstone", path,
                                    version, kMapSchemaVersion));
  if (version < 1) throw MapStoreError(fmt::format("{}: map schema {} is not known", path, version));
}

void create_schema(Sqlite& db) {
  Transaction transaction(db);
  db.execute(kSchema);
  db.execute(fmt::format("PRAGMA application_id = {}", kApplicationId).c_str());
  db.execute(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion).c_str());
  transaction.commit();
}

bool is_sane(const TrajectoryPose& pose) {
  return is_finite(pose.T_map_base);
}

}  // namespace

MapReader::MapReader(const std::string& path) : path_(path) {
  if (!std::filesystem::exists(path)) throw MapStoreError(fmt::format("{}: no such file", path));
  for_file(path, [&] {
    db_ = std::make_unique<Sqlite>(path, Sqlite::Mode::kReadOnly);
    check_identity(*db_, path);
  });
}

MapReader::~MapReader() = default;

std::int32_t MapReader::schema() const {
  return for_file(path_, [&] { return static_cast<std::int32_t>(db_->integer("PRAGMA user_version")); });
}

std::int32_t MapReader::epoch() const {
  return for_file(
      path_, [&] { return static_cast<std::int32_t>(db_->integer("SELECT value FROM meta WHERE key = 'epoch'")); });
}

std::vector<MapTile> MapReader::tiles() const {
  return for_file(path_, [&] {
    std::vector<MapTile> tiles;
    Statement rows(*db_, "SELECT x, y, utime, z_origin, cells FROM tiles ORDER BY x, y");
    while (rows.step()) {
      MapTile& tile = tiles.emplace_back();
      tile.key = {static_cast<std::int32_t>(rows.integer(0)), static_cast<std::int32_t>(rows.integer(1))};
      tile.utime = rows.integer(2);
      tile.z_origin = static_cast<float>(rows.real(3));
      if (!std::isfinite(tile.z_origin) || !unpack_cells(rows.blob(4), tile))
        throw MapStoreError(fmt::format("{}: tile ({}, {}) is damaged", path_, tile.key.x, tile.key.y));
    }
    return tiles;
  });
}

std::vector<CurbLine> MapReader::curbs() const {
  return for_file(path_, [&] {
    std::vector<CurbLine> lines;
    Statement rows(*db_, "SELECT id, dropped, confidence, points FROM curbs ORDER BY id");
    while (rows.step()) {
      const auto id = static_cast<std::int32_t>(rows.integer(0));
      auto points = unpack_vertices(rows.blob(3));
      if (!points) throw MapStoreError(fmt::format("{}: curb {} is damaged", path_, id));
      lines.push_back({id, static_cast<float>(rows.real(2)), rows.integer(1) != 0, std::move(*points)});
    }
    return lines;
  });
}

std::vector<TrajectoryPose> MapReader::trajectory() const {
  return for_file(path_, [&] {
    std::vector<TrajectoryPose> poses;
    Statement rows(*db_, "SELECT utime, revolution, x, y, z, qw, qx, qy, qz FROM trajectory ORDER BY utime");
    while (rows.step()) {
      const double position[3] = {rows.real(2), rows.real(3), rows.real(4)};
      const double orientation[4] = {rows.real(5), rows.real(6), rows.real(7), rows.real(8)};
      poses.push_back(
          {rows.integer(0), static_cast<std::int32_t>(rows.integer(1)), pose_from_arrays(position, orientation)});
      if (!is_sane(poses.back())) throw MapStoreError(fmt::format("{}: a pose is damaged", path_));
    }
    return poses;
  });
}

std::string MapReader::integrity() const {
  return for_file(path_, [&] {
    Statement rows(*db_, "PRAGMA integrity_check");
    return rows.step() ? rows.text(0) : std::string("no answer");
  });
}

/// flock() on the map itself. (Not SQLite's exclusive mode: readers are welcome.)
struct MapStore::Lock {
  explicit Lock(const std::string& path) : fd(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (fd < 0) throw MapStoreError(fmt::format("{}: {}", path, std::strerror(errno)));
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
      close(fd);
      throw MapStoreError(
          fmt::format("{}: another semantic map service writes it; stop that one, or use another file", path));
    }
  }
  ~Lock() { close(fd); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  int fd;
};

MapStore::MapStore(std::string path) : path_(std::move(path)), lock_(std::make_unique<Lock>(path_)) {
  for_file(path_, [&] {
    db_ = std::make_unique<Sqlite>(path_, Sqlite::Mode::kReadWrite);
    const bool fresh = std::filesystem::file_size(path_) == 0;
    if (!fresh) check_identity(*db_, path_);
    // A row of a tile (0.7 kB, at most 1.3) shall fit beside others: of a 4 kB page SQLite gives a row without rowid a
    // quarter at most and takes whole pages for the rest. The file is a third smaller than with 4 kB.
    if (fresh) db_->execute("PRAGMA page_size = 8192");
    db_->execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON");
    // Another server may have died between creating the file and the schema: then it is still empty.
    if (fresh) create_schema(*db_);
    // Rows of schema 1 are known by their size and may stay.
    if (db_->integer("PRAGMA user_version") < kMapSchemaVersion)
      db_->execute(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion).c_str());
    epoch_ = static_cast<std::int32_t>(db_->integer("SELECT value FROM meta WHERE key = 'epoch'"));
    last_utime_ = db_->integer("SELECT max(utime) FROM trajectory");
  });
}

MapStore::~MapStore() = default;

void MapStore::write(const Batch& batch) {
  if (!db_) throw MapStoreError(fmt::format("{}: is closed", path_));
  for_file(path_, [&] {
    Transaction transaction(*db_);
    if (batch.clear) db_->execute("DELETE FROM tiles; DELETE FROM curbs; DELETE FROM trajectory");
    Statement(*db_, "UPDATE meta SET value = ? WHERE key = 'epoch'").bind(batch.epoch).run();

    Statement put_tile(*db_, "INSERT OR REPLACE INTO tiles VALUES(?, ?, ?, ?, ?)");
    for (const MapTile& tile : batch.tiles) {
      put_tile.bind(tile.key.x, tile.key.y, tile.utime, double{tile.z_origin},
                    std::span<const std::uint8_t>(pack_cells(tile)));
      put_tile.run();
    }
    Statement put_pose(*db_, "INSERT OR REPLACE INTO trajectory VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
    for (const TrajectoryPose& pose : batch.trajectory) {
      double p[3];
      double q[4];
      pose_to_arrays(pose.T_map_base, p, q);
      put_pose.bind(pose.utime, pose.revolution, p[0], p[1], p[2], q[0], q[1], q[2], q[3]).run();
    }
    if (batch.curbs != nullptr) {
      db_->execute("DELETE FROM curbs");
      Statement put_curb(*db_, "INSERT INTO curbs VALUES(?, ?, ?, ?)");
      for (const CurbLine& line : *batch.curbs) {
        put_curb.bind(line.id, std::int64_t{line.dropped}, double{line.confidence},
                      std::span<const std::uint8_t>(pack_vertices(line.points)));
        put_curb.run();
      }
    }
    transaction.commit();
  });
  epoch_ = batch.epoch;
  if (batch.clear) last_utime_ = 0;
  for (const TrajectoryPose& pose : batch.trajectory) last_utime_ = std::max(last_utime_, pose.utime);
}

void MapStore::close_canonical() {
  if (!db_) return;
  // VACUUM INTO writes a new file with the rows in key order and a fresh header: the same content is the same bytes,
  // however many transactions it took. The rename makes it the map in one step.
  const std::string fresh = path_ + ".canonical";
  try {
    for_file(path_, [&] {
      std::filesystem::remove(fresh);
      Statement(*db_, "VACUUM INTO ?").bind(fresh).run();
      db_.reset();  // takes -wal and -shm with it
      std::filesystem::rename(fresh, path_);
    });
  } catch (const std::filesystem::filesystem_error& error) {
    throw MapStoreError(fmt::format("{}: {}", path_, error.what()));
  } catch (const MapStoreError&) {
    std::error_code ignored;
    std::filesystem::remove(fresh, ignored);
    throw;
  }
}

}  // namespace curbstone
