#pragma once

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "common/file_kind/file_kind.hpp"
#include "services/semantic_map/store/map_store.hpp"

/// @file
/// What reading and writing a map file share. Included by their sources only.

namespace curbstone::semantic_map::store {

inline constexpr std::int32_t kApplicationId = 0x43555242;  // "CURB"
inline constexpr int kBusyTimeout = 2000;                   // ms

/// A file system that has lost power may leave zeros where data was not written yet.
inline bool begins_with_zeros(const std::string& path) {
  std::array<char, 16> head{};  // as long as SQLite's magic
  std::ifstream file(path, std::ios::binary);
  return file.read(head.data(), head.size()) && std::ranges::all_of(head, [](char c) { return c == 0; });
}

/// Runs `work`; an SQLite error becomes one line that names the file.
template <class Work>
auto for_file(const std::string& path, Work work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    const int code = error.getErrorCode() & 0xff;  // without what extends it
    if (code == SQLITE_CORRUPT || (code == SQLITE_NOTADB && begins_with_zeros(path)))
      throw DamagedMapFile(
          fmt::format("{}: {} (damaged: move it away, or mend it with 'sqlite3 FILE .recover')", path, error.what()));
    if (code == SQLITE_NOTADB) {
      const std::string_view kind = file_kind(path);
      throw WrongMapFile(kind.empty() ? fmt::format("{}: {} (not a curbstone map)", path, error.what())
                                      : fmt::format("{}: not a curbstone map, but {}", path, kind));
    }
    throw MapStoreError(
        fmt::format("{}: {}{}", path, error.what(), code == SQLITE_FULL ? " (no room on the disk)" : ""));
  }
}

/// The first column of the first row; 0 if there is none.
inline std::int64_t integer(SQLite::Database& db, const char* sql) {
  SQLite::Statement statement(db, sql);
  return statement.executeStep() ? statement.getColumn(0).getInt64() : 0;
}

/// Valid until the statement's next step.
inline std::span<const std::uint8_t> blob(const SQLite::Column& column) {
  const auto* data = static_cast<const std::uint8_t*>(column.getBlob());
  return {data, data == nullptr ? 0 : static_cast<std::size_t>(column.getBytes())};
}

/// Maps of schema 2, and the first ones of schema 3, lack this column.
inline bool has_inferred(SQLite::Database& db) {
  return integer(db, "SELECT count(*) FROM pragma_table_info('curbs') WHERE name = 'inferred'") > 0;
}

inline std::int32_t stored_epoch(SQLite::Database& db) {
  return static_cast<std::int32_t>(integer(db, "SELECT value FROM meta WHERE key = 'epoch'"));
}

/// Throws WrongMapFile unless the file is a map of a known schema.
inline void check_identity(SQLite::Database& db, const std::string& path) {
  if (integer(db, "PRAGMA application_id") != kApplicationId)
    throw WrongMapFile(fmt::format("{}: is an SQLite file but not a curbstone map", path));
  const std::int64_t version = integer(db, "PRAGMA user_version");
  if (version > kMapSchemaVersion)
    throw WrongMapFile(fmt::format("{}: map schema {} is newer than this program's {}: use a newer curbstone", path,
                                   version, kMapSchemaVersion));
  if (version < 1) throw WrongMapFile(fmt::format("{}: map schema {} is not known", path, version));
}

}  // namespace curbstone::semantic_map::store
