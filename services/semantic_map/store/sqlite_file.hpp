#pragma once

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <cstdint>
#include <string>

#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::semantic_map::store {

/// @file
/// What reading and writing a map file have in common.

inline constexpr std::int32_t kApplicationId = 0x43555242;  // "CURB"
inline constexpr int kBusyTimeout = 2000;                   // ms

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
std::int64_t integer(SQLite::Database& db, const char* sql);
std::int32_t stored_epoch(SQLite::Database& db);
/// Throws unless the file is a map of a schema that we know.
void check_identity(SQLite::Database& db, const std::string& path);

}  // namespace curbstone::semantic_map::store
