#pragma once

namespace curbstone::mapper::config {

/// What becomes of the map on disk.
enum class MapMode {
  kMap,       ///< a new map begins, and takes the place of the one there
  kExtend,    ///< the drive goes on with it
  kLocalise,  ///< it is used, and stays as it is
};

}  // namespace curbstone::mapper::config
