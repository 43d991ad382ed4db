#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <string>

namespace curbstone::semantic_map::store {

/// Moves all of a map's journal into the map, as its writer does from time to time.
inline void empty_journal(const std::string& map) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open_v2(map.c_str(), &db, SQLITE_OPEN_READWRITE, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(db, "PRAGMA wal_checkpoint(TRUNCATE)", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(db);
}

}  // namespace curbstone::semantic_map::store
