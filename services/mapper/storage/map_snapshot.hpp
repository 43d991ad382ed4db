#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

/// Versions of the files of a map, without their content: equal versions mean equal files.
struct MapVersions {
  struct Tile {
    std::int64_t utime;    ///< us, of the newest point
    std::int64_t removed;  ///< us, of the last removal
    std::size_t records;
    std::int32_t z_origin;  ///< m in map
    bool operator==(const Tile&) const = default;
  };
  struct Node {
    std::int64_t utime;  ///< us
    Eigen::Matrix4d T_map_base;
    std::size_t points;
    bool operator==(const Node&) const = default;
  };
  std::int32_t epoch = 0;  ///< versions of tiles are comparable within one epoch
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles;
  std::vector<Node> nodes;
  std::size_t edges = 0;
  std::int32_t rings = 0;  ///< scans that the intensity scale was made from
  bool operator==(const MapVersions&) const = default;
};

/// A map at one moment, without the points that are on the disk already.
struct MapSnapshot {
  SavedMap map;
  MapVersions versions;
};

/// Takes a snapshot of all that the folder does not hold already. Spilled tiles stay spilled. `voxel`: m, of the dense
/// map.
[[nodiscard]] MapSnapshot take_snapshot(const dense_map::DenseMap& dense, const pose_graph::Atlas& atlas, double voxel,
                                        std::int32_t epoch, const MapVersions& on_disk);

}  // namespace curbstone::mapper::storage
