#include "services/semantic_map/store/map_store.hpp"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <span>
#include <vector>

#include "services/semantic_map/store/map_store_blobs.hpp"

namespace curbstone::semantic_map::store {

namespace {

constexpr std::int32_t kApplicationId = 0x43555242;  // "CURB"
constexpr int kBusyTimeout = 2000;                   // ms

constexpr const char* kSchema = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE tiles(x INTEGER, y INTEGER, utime INTEGER NOT NULL, z_origin REAL NOT NULL, cells BLOB NOT NULL,
                   PRIMARY KEY(x, y)) WITHOUT ROWID;
CREATE TABLE curbs(id INTEGER PRIMARY KEY, dropped INTEGER NOT NULL, confidence REAL NOT NULL, points BLOB NOT NULL,
                   inferred INTEGER NOT NULL DEFAULT 0);
CREATE TABLE trajectory(utime INTEGER PRIMARY KEY, revolution INTEGER NOT NULL, x REAL NOT NULL, y REAL NOT NULL,
                        z REAL NOT NULL, qw REAL NOT NULL, qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL);
INSERT INTO meta VALUES('tile_size', 3.0), ('cell_size', 0.12), ('epoch', 0);
)";

/// Runs `work`; what SQLite says becomes one line that names the file.
template <class Work>
auto for_file(const std::string& path, Work work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    std::string hint;
    const int code = error.getErrorCode() & 0xff;  // without what extends it
    if (code == SQLITE_NOTADB) hint = " (not a curbstone map)";
    if (code == SQLITE_CORRUPT) hint = " (damaged: move it away, or mend it with 'sqlite3 FILE .recover')";
    if (code == SQLITE_FULL) hint = " (no room on the disk)";
    throw MapStoreError(fmt::format("{}: {}{}", path, error.what(), hint));
  }
}

/// The first column of the first row; 0 if there is none.
std::int64_t integer(SQLite::Database& db, const char* sql) {
  SQLite::Statement statement(db, sql);
  return statement.executeStep() ? statement.getColumn(0).getInt64() : 0;
}

/// Valid until the statement's next step.
std::span<const std::uint8_t> blob(const SQLite::Column& column) {
  const auto* data = static_cast<const std::uint8_t*>(column.getBlob());
  return {data, data == nullptr ? 0 : static_cast<std::size_t>(column.getBytes())};
}

/// `bytes` must live until the statement was run.
void bind(SQLite::Statement& statement, int index, const std::vector<std::uint8_t>& bytes) {
  statement.bindNoCopy(index, bytes.data(), static_cast<int>(bytes.size()));
}

/// Runs what is bound, and leaves the statement ready for the next row.
void run(SQLite::Statement& statement) {
  statement.exec();
  statement.reset();
}

/// Maps of schema 2 and before have no such curbs.
bool has_inferred(SQLite::Database& db) {
  return integer(db, "SELECT count(*) FROM pragma_table_info('curbs') WHERE name = 'inferred'") > 0;
}

std::int32_t stored_epoch(SQLite::Database& db) {
  return static_cast<std::int32_t>(integer(db, "SELECT value FROM meta WHERE key = 'epoch'"));
}

/// Throws unless the file is a map of a schema that we know.
void check_identity(SQLite::Database& db, const std::string& path) {
  if (integer(db, "PRAGMA application_id") != kApplicationId)
    throw MapStoreError(fmt::format("{}: is an SQLite file but not a curbstone map", path));
  const std::int64_t version = integer(db, "PRAGMA user_version");
  if (version > kMapSchemaVersion)
    throw MapStoreError(fmt::format("{}: map schema {} is newer than this program's {}: use a newer curbstone", path,
                                    version, kMapSchemaVersion));
  if (version < 1) throw MapStoreError(fmt::format("{}: map schema {} is not known", path, version));
}

void create_schema(SQLite::Database& db) {
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  db.exec(kSchema);
  db.exec(fmt::format("PRAGMA application_id = {}", kApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion));
  transaction.commit();
}

bool is_sane(const tile::TrajectoryPose& pose) {
  return is_finite(pose.T_map_base);
}

/// Makes the folder where there is none: on a fresh machine the first map is the first thing there.
int open_in_its_folder(const std::string& path) {
  std::error_code ignored;  // open() says it
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  return open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
}

}  // namespace

MapReader::MapReader(const std::string& path) : path_(path) {
  if (!std::filesystem::exists(path)) throw MapStoreError(fmt::format("{}: no such file", path));
  for_file(path, [&] {
    db_ = std::make_unique<SQLite::Database>(path, SQLite::OPEN_READONLY, kBusyTimeout);
    check_identity(*db_, path);
  });
}

MapReader::~MapReader() = default;

std::int32_t MapReader::schema() const {
  return for_file(path_, [&] { return static_cast<std::int32_t>(integer(*db_, "PRAGMA user_version")); });
}

std::int32_t MapReader::epoch() const {
  return for_file(path_, [&] { return stored_epoch(*db_); });
}

std::vector<tile::MapTile> MapReader::tiles() const {
  return for_file(path_, [&] {
    std::vector<tile::MapTile> tiles;
    SQLite::Statement rows(*db_, "SELECT x, y, utime, z_origin, cells FROM tiles ORDER BY x, y");
    while (rows.executeStep()) {
      tile::MapTile& tile = tiles.emplace_back();
      tile.key = {static_cast<std::int32_t>(rows.getColumn(0).getInt64()),
                  static_cast<std::int32_t>(rows.getColumn(1).getInt64())};
      tile.utime = rows.getColumn(2).getInt64();
      tile.z_origin = static_cast<float>(rows.getColumn(3).getDouble());
      if (!std::isfinite(tile.z_origin) || !unpack_cells(blob(rows.getColumn(4)), tile))
        throw MapStoreError(fmt::format("{}: tile ({}, {}) is damaged", path_, tile.key.x, tile.key.y));
    }
    return tiles;
  });
}

std::vector<tile::CurbLine> MapReader::curbs() const {
  return for_file(path_, [&] {
    std::vector<tile::CurbLine> lines;
    SQLite::Statement rows(*db_, fmt::format("SELECT id, dropped, confidence, points, {} FROM curbs ORDER BY id",
                                             has_inferred(*db_) ? "inferred" : "0"));
    while (rows.executeStep()) {
      const auto id = static_cast<std::int32_t>(rows.getColumn(0).getInt64());
      auto points = unpack_vertices(blob(rows.getColumn(3)));
      if (!points) throw MapStoreError(fmt::format("{}: curb {} is damaged", path_, id));
      lines.push_back({id, static_cast<float>(rows.getColumn(2).getDouble()), rows.getColumn(1).getInt64() != 0,
                       std::move(*points), rows.getColumn(4).getInt64() != 0});
    }
    return lines;
  });
}

std::vector<tile::TrajectoryPose> MapReader::trajectory() const {
  return for_file(path_, [&] {
    std::vector<tile::TrajectoryPose> poses;
    SQLite::Statement rows(*db_, "SELECT utime, revolution, x, y, z, qw, qx, qy, qz FROM trajectory ORDER BY utime");
    while (rows.executeStep()) {
      const double position[3] = {rows.getColumn(2).getDouble(), rows.getColumn(3).getDouble(),
                                  rows.getColumn(4).getDouble()};
      const double orientation[4] = {rows.getColumn(5).getDouble(), rows.getColumn(6).getDouble(),
                                     rows.getColumn(7).getDouble(), rows.getColumn(8).getDouble()};
      poses.push_back({rows.getColumn(0).getInt64(), static_cast<std::int32_t>(rows.getColumn(1).getInt64()),
                       pose_from_arrays(position, orientation)});
      if (!is_sane(poses.back())) throw MapStoreError(fmt::format("{}: a pose is damaged", path_));
    }
    return poses;
  });
}

std::string MapReader::integrity() const {
  return for_file(path_, [&] {
    SQLite::Statement rows(*db_, "PRAGMA integrity_check");
    return rows.executeStep() ? rows.getColumn(0).getString() : std::string("no answer");
  });
}

/// flock() on the map itself. (Not SQLite's exclusive mode: readers are welcome.)
struct MapStore::Lock {
  explicit Lock(const std::string& path) : fd(open_in_its_folder(path)) {
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
    db_ = std::make_unique<SQLite::Database>(path_, SQLite::OPEN_READWRITE, kBusyTimeout);
    const bool fresh = std::filesystem::file_size(path_) == 0;
    if (!fresh) check_identity(*db_, path_);
    // A row of a tile (0.7 kB, at most 1.3) shall fit beside others: of a 4 kB page SQLite gives a row without rowid a
    // quarter at most and takes whole pages for the rest. The file is a third smaller than with 4 kB.
    if (fresh) db_->exec("PRAGMA page_size = 8192");
    db_->exec("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON");
    // Another server may have died between creating the file and the schema: then it is still empty.
    if (fresh) create_schema(*db_);
    // Tiles of schema 1 are known by their size and may stay.
    if (!has_inferred(*db_)) db_->exec("ALTER TABLE curbs ADD COLUMN inferred INTEGER NOT NULL DEFAULT 0");
    if (integer(*db_, "PRAGMA user_version") < kMapSchemaVersion)
      db_->exec(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion));
    epoch_ = stored_epoch(*db_);
    first_utime_ = integer(*db_, "SELECT min(utime) FROM trajectory");
    last_utime_ = integer(*db_, "SELECT max(utime) FROM trajectory");
  });
}

MapStore::~MapStore() = default;

void MapStore::write(const Batch& batch) {
  if (!db_) throw MapStoreError(fmt::format("{}: is closed", path_));
  if (batch.clear && !batch.keep_in.empty()) copy_to(batch.keep_in);
  for_file(path_, [&] {
    SQLite::Transaction transaction(*db_, SQLite::TransactionBehavior::IMMEDIATE);
    if (batch.clear) db_->exec("DELETE FROM tiles; DELETE FROM curbs; DELETE FROM trajectory");
    SQLite::Statement put_epoch(*db_, "UPDATE meta SET value = ? WHERE key = 'epoch'");
    put_epoch.bind(1, batch.epoch);
    run(put_epoch);

    SQLite::Statement put_tile(*db_, "INSERT OR REPLACE INTO tiles VALUES(?, ?, ?, ?, ?)");
    for (const tile::MapTile& tile : batch.tiles) {
      const std::vector<std::uint8_t> cells = pack_cells(tile);
      SQLite::bind(put_tile, tile.key.x, tile.key.y, tile.utime, double{tile.z_origin});
      bind(put_tile, 5, cells);
      run(put_tile);
    }
    SQLite::Statement put_pose(*db_, "INSERT OR REPLACE INTO trajectory VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
    for (const tile::TrajectoryPose& pose : batch.trajectory) {
      double p[3];
      double q[4];
      pose_to_arrays(pose.T_map_base, p, q);
      SQLite::bind(put_pose, pose.utime, pose.revolution, p[0], p[1], p[2], q[0], q[1], q[2], q[3]);
      run(put_pose);
    }
    if (batch.curbs != nullptr) {
      db_->exec("DELETE FROM curbs");
      SQLite::Statement put_curb(*db_, "INSERT INTO curbs VALUES(?, ?, ?, ?, ?)");
      for (const tile::CurbLine& line : *batch.curbs) {
        const std::vector<std::uint8_t> points = pack_vertices(line.points);
        SQLite::bind(put_curb, line.id, std::int64_t{line.dropped}, double{line.confidence});
        bind(put_curb, 4, points);
        put_curb.bind(5, std::int64_t{line.inferred});
        run(put_curb);
      }
    }
    transaction.commit();
  });
  epoch_ = batch.epoch;
  if (batch.clear) first_utime_ = last_utime_ = 0;
  for (const tile::TrajectoryPose& pose : batch.trajectory) {
    first_utime_ = first_utime_ == 0 ? pose.utime : std::min(first_utime_, pose.utime);
    last_utime_ = std::max(last_utime_, pose.utime);
  }
}

std::string MapStore::free_name() const {
  const std::filesystem::path file(path_);
  const std::time_t second = first_utime_ / 1'000'000;
  const std::string stem = fmt::format("{}-{:%Y%m%dT%H%M%SZ}", file.stem().string(), fmt::gmtime(second));
  std::filesystem::path name;
  std::error_code ignored;
  for (int i = 1; i == 1 || std::filesystem::exists(name, ignored); ++i)
    name = file.parent_path() / (stem + (i == 1 ? "" : fmt::format("-{}", i)) + file.extension().string());
  return name.string();
}

/// A copy and not a rename: readers may have the file open, and what they see must stay one map.
void MapStore::copy_to(const std::string& path) {
  const std::string unfinished = path + ".unfinished";
  try {
    for_file(path_, [&] {
      std::filesystem::remove(unfinished);
      SQLite::Statement vacuum(*db_, "VACUUM INTO ?");
      vacuum.bind(1, unfinished);
      vacuum.exec();
      std::filesystem::rename(unfinished, path);
    });
  } catch (const std::filesystem::filesystem_error& error) {
    throw MapStoreError(fmt::format("{}: {}", path, error.what()));
  } catch (const MapStoreError&) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
}

void MapStore::close_canonical() {
  if (!db_) return;
  // VACUUM INTO writes a new file with the rows in key order and a fresh header: the same content is the same bytes,
  // however many transactions it took. The rename makes it the map in one step.
  const std::string fresh = path_ + ".canonical";
  try {
    for_file(path_, [&] {
      std::filesystem::remove(fresh);
      {
        SQLite::Statement vacuum(*db_, "VACUUM INTO ?");
        vacuum.bind(1, fresh);
        vacuum.exec();
      }
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

}  // namespace curbstone::semantic_map::store
