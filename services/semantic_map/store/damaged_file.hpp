#pragma once

#include <string>

namespace curbstone::semantic_map::store {

/// Renames a map file that is damaged, with its journal: sqlite3 may still read a part of it. Returns its new name,
/// `map-damaged-<UTC of its last change>.db` beside it. Throws MapStoreError.
[[nodiscard]] std::string set_damaged_aside(const std::string& path);

/// Renames a file that was put in the place of the map during a drive, `with_journal` if the one there came with it.
/// Returns its new name, `map-replaced-<UTC of its last change>.db` beside it. Throws MapStoreError.
[[nodiscard]] std::string set_replacement_aside(const std::string& path, bool with_journal);

}  // namespace curbstone::semantic_map::store
