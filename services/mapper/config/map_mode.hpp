#pragma once

namespace curbstone::mapper::config {

/// How the drive uses the map on disk.
enum class MapMode {
  kMap,       ///< begins a new map, which replaces the one on disk
  kExtend,    ///< extends the map on disk
  kLocalise,  ///< localises in the map on disk and does not change it
};

}  // namespace curbstone::mapper::config
