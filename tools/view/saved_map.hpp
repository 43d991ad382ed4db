#pragma once

#include <cstdint>
#include <string>

#include "services/viewer/viewer_node.hpp"

namespace curbstone::view {

/// Whether the file is a map rather than a log, by its first bytes. Throws std::runtime_error if it cannot be read.
[[nodiscard]] bool is_map_file(const std::string& file);

/// Passes the content of a map file to the node: tiles, curbs and the path. `now`: us, as in the node's tick(). Throws
/// MapStoreError.
void show_saved_map(const std::string& file, std::int64_t now, viewer::ViewerNode& node);

}  // namespace curbstone::view
