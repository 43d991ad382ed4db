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

/// A tile of the dense map; its points are in the order in which they were added.
struct SavedTile {
  TileKey key;
  std::int32_t z_origin = 0;  ///< m in map
  std::int64_t utime = 0;     ///< us, of the newest point
  std::vector<TilePoint> points;
  bool on_disk = false;  ///< the folder that it will be saved to holds this very tile, and `points` is empty
  dense_map::PackedRecords spilled = {};     ///< if not empty: `points` is, and these are read when the tile is saved
  std::optional<std::int64_t> earlier = {};  ///< us, `utime` of an earlier version that the folder holds
};

/// What outlives a drive: the dense map, the nodes from which the map for registration is rebuilt, and the graph that
/// connects them. Nothing specific to the vehicle but its LiDAR's intensities on a road.
struct SavedMap {
  double voxel = 0.05;     ///< m, of the dense map
  std::int32_t epoch = 1;  ///< of its tiles
  std::vector<SavedTile> tiles;
  std::vector<scan::Keyframe> nodes;
  std::size_t nodes_on_disk = 0;  ///< number of leading nodes whose scans the folder holds; their `points` are empty
  std::vector<pose_graph::PoseEdge> edges;
  intensity::RingHistograms
      rings;  ///< of the LiDAR that made the map: its intensity scale; empty: intensities are unscaled
};

/// One line that names the file and the fault.
class MapFolderError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace curbstone::mapper::storage
