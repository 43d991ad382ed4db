#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "services/semantic_map/store/map_file.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "services/semantic_map/store/map_store_blobs.hpp"

namespace curbstone::semantic_map::store {
namespace {

constexpr std::int64_t kMaxKey = 1'000'000;  // of a tile: 3000 km
constexpr double kMaxPlace = 3e6;            // m
constexpr float kMaxHeight = 1e5F;           // m

TileKey key_of(SQLite::Statement& row, const std::string& path) {
  const std::int64_t x = row.getColumn(0).getInt64(), y = row.getColumn(1).getInt64();
  if (x < -kMaxKey || x > kMaxKey || y < -kMaxKey || y > kMaxKey)
    throw MapStoreError(fmt::format("{}: tile ({}, {}) is damaged: none is so far from the origin", path, x, y));
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
}

/// Reads a row of x, y, utime, z_origin, cells.
tile::MapTile tile_of(SQLite::Statement& row, const std::string& path) {
  tile::MapTile tile;
  tile.key = key_of(row, path);
  tile.utime = row.getColumn(2).getInt64();
  tile.z_origin = static_cast<float>(row.getColumn(3).getDouble());
  const bool has_height = std::abs(tile.z_origin) <= kMaxHeight;  // false of NaN
  if (!has_height || !unpack_cells(blob(row.getColumn(4)), tile))
    throw MapStoreError(fmt::format("{}: tile ({}, {}) is damaged", path, tile.key.x, tile.key.y));
  return tile;
}

bool is_sane(const tile::TrajectoryPose& pose) {
  return is_finite(pose.T_map_base) && pose.T_map_base.translation().cwiseAbs().maxCoeff() <= kMaxPlace;
}

}  // namespace

MapReader::MapReader(const std::string& path) : path_(path) {
  if (!std::filesystem::exists(path)) throw MapStoreError(fmt::format("{}: no such file", path));
  if (std::filesystem::is_directory(path)) throw MapStoreError(fmt::format("{}: is a folder, not a map", path));
  if (access(path.c_str(), R_OK) != 0)
    throw MapStoreError(fmt::format("{}: cannot be read: {}", path, std::generic_category().message(errno)));
  std::error_code has_no_size;  // a device
  if (std::filesystem::file_size(path, has_no_size) == 0)
    throw WrongMapFile(fmt::format("{}: not a curbstone map: it is empty", path));
  for_file(path, [&] {
    db_ = std::make_unique<SQLite::Database>(path, SQLite::OPEN_READONLY, kBusyTimeout);
    try {
      check_identity(*db_, path);
    } catch (const SQLite::Exception& error) {
      // SQLite needs a -shm file beside a map with a -wal file.
      if (error.getErrorCode() != SQLITE_CANTOPEN && error.getErrorCode() != SQLITE_READONLY) throw;
      throw MapStoreError(
          fmt::format("{}: its drive has not ended: copy it and {}-wal into a folder that can be written", path,
                      std::filesystem::path(path).filename().string()));
    }
  });
}

MapReader::~MapReader() = default;

MapReader::Moment::Moment(const MapReader& reader) : reader_(reader) {
  for_file(reader_.path_, [&] { reader_.db_->exec("BEGIN"); });
}

MapReader::Moment::~Moment() {
  (void)reader_.db_->tryExec("COMMIT");
}

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
    while (rows.executeStep()) tiles.push_back(tile_of(rows, path_));
    return tiles;
  });
}

std::vector<TileKey> MapReader::tile_keys() const {
  return for_file(path_, [&] {
    std::vector<TileKey> keys;
    SQLite::Statement rows(*db_, "SELECT x, y FROM tiles ORDER BY x, y");
    while (rows.executeStep()) keys.push_back(key_of(rows, path_));
    return keys;
  });
}

std::optional<tile::MapTile> MapReader::tile(TileKey key) const {
  return for_file(path_, [&]() -> std::optional<tile::MapTile> {
    if (!one_tile_)
      one_tile_ = std::make_unique<SQLite::Statement>(
          *db_, "SELECT x, y, utime, z_origin, cells FROM tiles WHERE x = ? AND y = ?");
    one_tile_->reset();
    one_tile_->bind(1, key.x);
    one_tile_->bind(2, key.y);
    std::optional<tile::MapTile> tile;
    if (one_tile_->executeStep()) tile = tile_of(*one_tile_, path_);
    one_tile_->reset();  // no lock on the file is kept
    return tile;
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
      const auto confidence = static_cast<float>(rows.getColumn(2).getDouble());
      if (!points || !(confidence >= 0 && confidence <= 1))
        throw MapStoreError(fmt::format("{}: curb {} is damaged", path_, id));
      lines.push_back(
          {id, confidence, rows.getColumn(1).getInt64() != 0, std::move(*points), rows.getColumn(4).getInt64() != 0});
    }
    return lines;
  });
}

std::vector<tile::MarkingLine> MapReader::markings() const {
  if (schema() < 3) return {};
  return for_file(path_, [&] {
    std::vector<tile::MarkingLine> lines;
    SQLite::Statement rows(*db_, "SELECT id, type, confidence, width, dash, gap, points FROM markings ORDER BY id");
    while (rows.executeStep()) {
      const auto number = [&](int column) { return static_cast<float>(rows.getColumn(column).getDouble()); };
      tile::MarkingLine& line = lines.emplace_back();
      line.id = static_cast<std::int32_t>(rows.getColumn(0).getInt64());
      const std::int64_t type = rows.getColumn(1).getInt64();
      line.confidence = number(2);
      line.width = number(3);
      line.dash = number(4);
      line.gap = number(5);
      auto points = unpack_marking_vertices(blob(rows.getColumn(6)));
      const bool is_sound = type >= 0 && type < tile::kNumMarkingTypes && std::isfinite(line.confidence) &&
                            std::isfinite(line.width) && std::isfinite(line.dash) && std::isfinite(line.gap);
      if (!points || !is_sound) throw MapStoreError(fmt::format("{}: marking {} is damaged", path_, line.id));
      line.type = static_cast<tile::MarkingType>(type);
      line.points = std::move(*points);
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

}  // namespace curbstone::semantic_map::store
