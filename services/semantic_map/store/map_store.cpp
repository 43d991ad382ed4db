#include "services/semantic_map/store/map_store.hpp"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <SQLiteCpp/VariadicBind.h>
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
#include <span>
#include <vector>

#include "common/time/dated_path.hpp"
#include "services/semantic_map/store/damaged_file.hpp"
#include "services/semantic_map/store/map_file.hpp"
#include "services/semantic_map/store/map_store_blobs.hpp"

namespace curbstone::semantic_map::store {

namespace {

constexpr const char* kMarkingsTable = R"(
CREATE TABLE IF NOT EXISTS markings(id INTEGER PRIMARY KEY, type INTEGER NOT NULL, confidence REAL NOT NULL, width REAL NOT NULL,
                      dash REAL NOT NULL, gap REAL NOT NULL, points BLOB NOT NULL);
)";

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

/// `bytes` must live until the statement has run.
void bind(SQLite::Statement& statement, int index, const std::vector<std::uint8_t>& bytes) {
  statement.bindNoCopy(index, bytes.data(), static_cast<int>(bytes.size()));
}

/// Runs the bound statement, and resets it for the next row.
void run(SQLite::Statement& statement) {
  statement.exec();
  statement.reset();
}

void create_schema(SQLite::Database& db) {
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  db.exec(kSchema);
  db.exec(kMarkingsTable);
  db.exec(fmt::format("PRAGMA application_id = {}", kApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion));
  transaction.commit();
}

/// Rows of schema 1 are recognised by their size and may stay.
void migrate(SQLite::Database& db) {
  const bool inferred = has_inferred(db);
  if (inferred && integer(db, "PRAGMA user_version") >= kMapSchemaVersion) return;
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  if (!inferred) db.exec("ALTER TABLE curbs ADD COLUMN inferred INTEGER NOT NULL DEFAULT 0");
  db.exec(kMarkingsTable);
  db.exec(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion));
  transaction.commit();
}

/// Creates the folder if there is none, as on a fresh machine.
int open_in_its_folder(const std::string& path) {
  std::error_code ignored;  // open() reports it
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  return open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
}

void put_meta(SQLite::Database& db, const MapStore::Batch& batch) {
  SQLite::Statement put_epoch(db, "UPDATE meta SET value = ? WHERE key = 'epoch'");
  put_epoch.bind(1, batch.epoch);
  run(put_epoch);
  if (batch.clear || batch.superseded) db.exec("DELETE FROM meta WHERE key = 'superseded'");
  if (!batch.superseded || batch.superseded->empty()) return;
  SQLite::Statement put_superseded(db, "INSERT INTO meta VALUES('superseded', ?)");
  put_superseded.bind(1, std::filesystem::path(*batch.superseded).filename().string());
  run(put_superseded);
}

void put_tiles(SQLite::Database& db, const std::vector<tile::MapTile>& tiles) {
  SQLite::Statement put(db, "INSERT OR REPLACE INTO tiles VALUES(?, ?, ?, ?, ?)");
  for (const tile::MapTile& tile : tiles) {
    const std::vector<std::uint8_t> cells = pack_cells(tile);
    SQLite::bind(put, tile.key.x, tile.key.y, tile.utime, double{tile.z_origin});
    bind(put, 5, cells);
    run(put);
  }
}

void put_poses(SQLite::Database& db, const std::vector<tile::TrajectoryPose>& poses) {
  SQLite::Statement put(db, "INSERT OR REPLACE INTO trajectory VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const tile::TrajectoryPose& pose : poses) {
    double p[3];
    double q[4];
    pose_to_arrays(pose.T_map_base, p, q);
    SQLite::bind(put, pose.utime, pose.revolution, p[0], p[1], p[2], q[0], q[1], q[2], q[3]);
    run(put);
  }
}

void replace_curbs(SQLite::Database& db, const std::vector<tile::CurbLine>& lines) {
  db.exec("DELETE FROM curbs");
  SQLite::Statement put(db, "INSERT INTO curbs VALUES(?, ?, ?, ?, ?)");
  for (const tile::CurbLine& line : lines) {
    const std::vector<std::uint8_t> points = pack_vertices(line.points);
    SQLite::bind(put, line.id, std::int64_t{line.dropped}, double{line.confidence});
    bind(put, 4, points);
    put.bind(5, std::int64_t{line.inferred});
    run(put);
  }
}

void replace_markings(SQLite::Database& db, const std::vector<tile::MarkingLine>& lines) {
  db.exec("DELETE FROM markings");
  SQLite::Statement put(db, "INSERT INTO markings VALUES(?, ?, ?, ?, ?, ?, ?)");
  for (const tile::MarkingLine& line : lines) {
    const std::vector<std::uint8_t> points = pack_vertices(line.points);
    SQLite::bind(put, line.id, static_cast<std::int32_t>(line.type), double{line.confidence}, double{line.width},
                 double{line.dash}, double{line.gap});
    bind(put, 7, points);
    run(put);
  }
}

}  // namespace

/// flock() on the map itself. (Not SQLite's exclusive mode, which would lock out readers.)
struct MapStore::Lock {
  explicit Lock(const std::string& path) : fd(open_in_its_folder(path)) {
    if (fd < 0) throw MapStoreError(fmt::format("{}: {}", path, std::strerror(errno)));
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
      close(fd);
      throw WrongMapFile(
          fmt::format("{}: another semantic map service writes it; stop that one, or use another file", path));
    }
  }
  ~Lock() { close(fd); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  int fd;
};

MapStore::MapStore(std::string path) : path_(std::move(path)), lock_(std::make_unique<Lock>(path_)), watch_(path_) {
  open();
}

void MapStore::open() {
  for_file(path_, [&] {
    db_ = std::make_unique<SQLite::Database>(path_, SQLite::OPEN_READWRITE, kBusyTimeout);
    const bool fresh = std::filesystem::file_size(path_) == 0;
    if (!fresh) check_identity(*db_, path_);
    // Several rows of tiles (0.7 kB, at most 1.3) must fit into a page. In a table without rowid SQLite gives a row at
    // most a quarter of a page, and stores the rest in whole pages of its own. The file is a third smaller than with 4
    // kB.
    if (fresh) db_->exec("PRAGMA page_size = 8192");
    db_->exec("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON");
    // Another server may have died between creating the file and the schema: then it is still empty.
    if (fresh) create_schema(*db_);
    migrate(*db_);
    epoch_ = stored_epoch(*db_);
    first_utime_ = integer(*db_, "SELECT min(utime) FROM trajectory");
    last_utime_ = integer(*db_, "SELECT max(utime) FROM trajectory");
    superseded_ = stored_superseded();
  });
  watch_.remember();
}

MapStore::~MapStore() = default;

/// What others did to the files since the last write.
void MapStore::heed_others() {
  switch (watch_.change()) {
    case FileWatch::Change::kNone:
      return;
    case FileWatch::Change::kDeleted:
      restore();
      restored_.push_back("the file was deleted during the drive, and has been written again with all that it had");
      return;
    case FileWatch::Change::kReplaced: {
      const std::string aside = set_replacement_aside_unless_in_use();
      restore();
      restored_.push_back(
          fmt::format("another file was put in its place during the drive: that one is {}, and the map has been "
                      "written again with all that it had",
                      aside));
      return;
    }
    case FileWatch::Change::kWritten:
      if (is_still_this_map()) return watch_.remember();
      sqlite3_db_config(db_->getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);  // it stays as it is
      throw DamagedMapFile(fmt::format("{}: somebody else wrote to it", path_));
  }
}

/// Throws if another process writes it.
std::string MapStore::set_replacement_aside_unless_in_use() const {
  if (!std::filesystem::is_directory(path_)) const Lock unused(path_);
  return set_replacement_aside(path_, watch_.journal_is_replaced());
}

/// Somebody may have touched the file, or told SQLite to tidy it. Read by another connection: that of the writer has
/// pages in memory.
bool MapStore::is_still_this_map() const {
  try {
    const MapReader map(path_);
    if (map.integrity() != "ok" || map.epoch() != epoch_) return false;
    const std::vector<tile::TrajectoryPose> drive = map.trajectory();
    return drive.empty() ? last_utime_ == 0 : drive.front().utime == first_utime_ && drive.back().utime == last_utime_;
  } catch (const MapStoreError&) {
    return false;
  }
}

/// SQLite continues to write to a deleted file, which is lost in the end; but it can still read it, so it is copied.
void MapStore::restore() {
  std::error_code ignored;  // copy_to() reports it
  const auto folder = std::filesystem::path(path_).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  const std::string restored = path_ + ".restored";
  copy_to(restored);
  std::error_code error;
  std::filesystem::rename(restored, path_, error);
  if (error) throw MapStoreError(fmt::format("{}: {}", path_, error.message()));
  auto lock = std::make_unique<Lock>(path_);
  db_.reset();  // takes -wal and -shm of that name with it
  lock_ = std::move(lock);
  watch_.remember();
  open();
}

void MapStore::write(const Batch& batch) {
  if (!db_) throw MapStoreError(fmt::format("{}: is closed", path_));
  heed_others();
  if (batch.clear && !batch.keep_in.empty()) copy_to(batch.keep_in);
  for_file(path_, [&] {
    SQLite::Transaction transaction(*db_, SQLite::TransactionBehavior::IMMEDIATE);
    if (batch.clear) db_->exec("DELETE FROM tiles; DELETE FROM curbs; DELETE FROM markings; DELETE FROM trajectory");
    put_meta(*db_, batch);
    put_tiles(*db_, batch.tiles);
    put_poses(*db_, batch.trajectory);
    if (batch.curbs != nullptr) replace_curbs(*db_, *batch.curbs);
    if (batch.markings != nullptr) replace_markings(*db_, *batch.markings);
    transaction.commit();
  });
  watch_.remember();
  epoch_ = batch.epoch;
  if (batch.clear) first_utime_ = last_utime_ = 0;
  if (batch.clear || batch.superseded) superseded_ = batch.superseded.value_or("");
  for (const tile::TrajectoryPose& pose : batch.trajectory) {
    first_utime_ = first_utime_ == 0 ? pose.utime : std::min(first_utime_, pose.utime);
    last_utime_ = std::max(last_utime_, pose.utime);
  }
}

/// Only names of the form that free_name() gives are accepted: the map may come from anywhere, and the file that it
/// names is removed.
std::string MapStore::stored_superseded() const {
  SQLite::Statement statement(*db_, "SELECT value FROM meta WHERE key = 'superseded'");
  if (!statement.executeStep()) return {};
  const std::filesystem::path file(path_);
  const std::filesystem::path name(statement.getColumn(0).getString());
  const bool is_ours = name == name.filename() && name.extension() == file.extension() &&
                       name.string().starts_with(file.stem().string() + "-");
  return is_ours ? (file.parent_path() / name).string() : "";
}

std::string MapStore::free_name() const {
  const std::filesystem::path file(path_);
  return free_dated_path((file.parent_path() / file.stem()).string(), first_utime_, file.extension().string());
}

/// A copy, not a rename: readers may have the file open and must keep a consistent map.
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
