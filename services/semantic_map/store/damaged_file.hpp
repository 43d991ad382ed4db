#pragma once

#include <string>

namespace curbstone::semantic_map::store {

/// Renames a map file that is damaged, with its journal: sqlite3 may still read a part of it. Returns its new name,
/// `map-damaged-<UTC of its last change>.db` beside it. Throws MapStoreError.
[[nodiscard]] std::string set_damaged_aside(const std::string& path);

}  // namespace curbstone::semantic_map::store
