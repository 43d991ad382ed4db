#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/tile_records.hpp"
#include "services/mapper/intensity/ring_histograms.hpp"
#include "services/mapper/pose_graph/pose_graph.hpp"
#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::storage {

/// A tile of the dense map; the order of its points is that in which they came.
struct SavedTile {
  TileKey key;
  std::int32_t z_origin = 0;  ///< m in map
  std::int64_t utime = 0;     ///< us, when the newest point came
  std::vector<TilePoint> points;
  bool on_disk = false;                ///< the folder that it will be saved to holds this very tile: `points` is empty
  dense_map::PackedRecords away = {};  ///< if not empty: `points` is, and these are read when the tile is saved
  std::optional<std::int64_t> earlier = {};  ///< us, the `utime` of an earlier version of it that the folder holds
};

/// All that outlives a drive: the dense map, the nodes from which the map for registration is built anew, and the
/// graph that holds them together. Of the vehicle nothing but what its LiDAR makes of a road.
struct SavedMap {
  double voxel = 0.05;     ///< m, of the dense map
  std::int32_t epoch = 1;  ///< of its tiles
  std::vector<SavedTile> tiles;
  std::vector<scan::Keyframe> nodes;
  std::size_t nodes_on_disk = 0;  ///< so many, the first: the folder holds their very scans, `points` is empty
  std::vector<pose_graph::PoseEdge> edges;
  intensity::RingHistograms rings;  ///< of the LiDAR that made it: the scale of its intensities; empty: as they came
};

/// One line that names the file and what is wrong with it.
class MapFolderError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace curbstone::mapper::storage
