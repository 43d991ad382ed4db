#pragma once

#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::output {

/// The content of a map file, for drawing: tiles, curbs, markings and the driven path. Throws MapStoreError.
[[nodiscard]] semantic_map::picture::MapPicture stored_picture(const semantic_map::store::MapReader& map);

}  // namespace curbstone::output
