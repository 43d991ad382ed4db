#include "services/semantic_map/store/sqlite_file.hpp"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Statement.h>

namespace curbstone::semantic_map::store {

std::int64_t integer(SQLite::Database& db, const char* sql) {
  SQLite::Statement statement(db, sql);
  return statement.executeStep() ? statement.getColumn(0).getInt64() : 0;
}

std::int32_t stored_epoch(SQLite::Database& db) {
  return static_cast<std::int32_t>(integer(db, "SELECT value FROM meta WHERE key = 'epoch'"));
}

void check_identity(SQLite::Database& db, const std::string& path) {
  if (integer(db, "PRAGMA application_id") != kApplicationId)
    throw MapStoreError(fmt::format("{}: is an SQLite file but not a curbstone map", path));
  const std::int64_t version = integer(db, "PRAGMA user_version");
  if (version > kMapSchemaVersion)
    throw MapStoreError(fmt::format("{}: map schema {} is newer than this program's {}: use a newer curbstone", path,
                                    version, kMapSchemaVersion));
  if (version < 1) throw MapStoreError(fmt::format("{}: map schema {} is not known", path, version));
}

}  // namespace curbstone::semantic_map::store
