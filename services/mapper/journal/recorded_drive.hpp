#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/tile_records.hpp"
#include "services/mapper/intensity/ring_histograms.hpp"
#include "services/mapper/pose_graph/pose_graph.hpp"
#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::journal {

/// Where the vehicle was at the end of a scan.
struct RecordedPose {
  std::int64_t utime = 0;  ///< us
  std::int32_t revolution = 0;
  std::int32_t node = 0;  ///< of the atlas, that it was at
  Pose T_map_base = Pose::Identity();
  Pose T_map_odom = Pose::Identity();
  bool with_odometry = false;       ///< T_map_odom is of this scan
  std::int64_t standing_since = 0;  ///< us, when the drive's first standstill began
  bool has_moved = false;           ///< since then
};

struct RecordedNode {
  scan::Keyframe kept;
  double driven = 0;  ///< m, as Atlas::driven()
};

/// A tile of the dense map as it stood.
struct RecordedTile {
  std::int32_t z_origin = 0;  ///< m in map
  dense_map::TileRecords content;
  dense_map::PackedRecords away = {};  ///< if not empty: `content` is, and these are it
  std::size_t touched = 0;             ///< while it is read: in which batch it grew last
};

/// What a mapper needs to go on with the drive of another that died.
struct RecordedDrive {
  std::string config_hash;  ///< of the mapper that made it
  std::int32_t epoch = 0;
  std::int32_t num_known = 0;  ///< nodes, the first, of an earlier drive's map
  std::vector<RecordedNode> nodes;
  std::vector<pose_graph::PoseEdge> edges;
  std::unordered_map<TileKey, RecordedTile, TileKeyHash> tiles;
  std::vector<RecordedPose> poses;  ///< in order; at least one
  intensity::RingHistograms rings;  ///< of which the scale of the tiles' intensities was made
};

/// One line that names the file and what is wrong with it.
class JournalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace curbstone::mapper::journal
