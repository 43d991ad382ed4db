#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

/// Tells apart what the files of a map have held, without looking into them: equal versions, equal files.
struct MapVersions {
  struct Tile {
    std::int64_t utime;    ///< us, of the newest point
    std::int64_t removed;  ///< us, when points were taken out last
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
  std::int32_t epoch = 0;  ///< versions of tiles compare within one
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles;
  std::vector<Node> nodes;
  std::size_t edges = 0;
  std::int32_t rings = 0;  ///< scans that the scale of intensities is of
  bool operator==(const MapVersions&) const = default;
};

/// A map at a moment, without the points that are on the disk already.
struct MapSnapshot {
  SavedMap map;
  MapVersions versions;
};

/// All of the map but what a folder holds already. Tiles that are away stay there. `voxel`: m, of the dense map.
[[nodiscard]] MapSnapshot take_snapshot(const dense_map::DenseMap& dense, const pose_graph::Atlas& atlas, double voxel,
                                        std::int32_t epoch, const MapVersions& on_disk);

}  // namespace curbstone::mapper::storage
