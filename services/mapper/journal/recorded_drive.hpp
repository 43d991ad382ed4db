#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/tile_records.hpp"
#include "services/mapper/intensity/ring_histograms.hpp"
#include "services/mapper/pose_graph/pose_graph.hpp"
#include "services/mapper/registration/shape_map.hpp"
#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::journal {

/// Pose of the vehicle at the end of a scan.
struct RecordedPose {
  std::int64_t utime = 0;  ///< us
  std::int32_t revolution = 0;
  std::int32_t node = 0;  ///< of the atlas, at the vehicle
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

/// A recorded tile of the dense map.
struct RecordedTile {
  std::int32_t z_origin = 0;  ///< m in map
  dense_map::TileRecords content;
  dense_map::PackedRecords spilled = {};  ///< if not empty, it holds the records, and `content` is empty
  std::size_t touched = 0;                ///< while reading: number of the batch in which it last grew
  std::size_t num_records = 0;            ///< of `content`, or of what `spilled` holds
  std::size_t num_runs = 0;               ///< likewise
};

/// The voxels of the map that scans are registered to.
struct RecordedLocalMap {
  std::int64_t utime = 0;  ///< us, end of a scan: all of its points and those before are in it, and perhaps later ones
  std::vector<std::vector<registration::VoxelSums>> levels;  ///< of several sums of one voxel the last ones count
  std::size_t bytes = 0;                                     ///< of the file, without a batch that was cut short
};

/// What a mapper needs to continue the drive of one that died.
struct RecordedDrive {
  std::string config_hash;  ///< of the mapper that recorded it
  std::int32_t epoch = 0;
  std::int32_t num_known = 0;  ///< number of leading nodes that are of an earlier drive's map
  std::vector<RecordedNode> nodes;
  std::vector<pose_graph::PoseEdge> edges;
  std::unordered_map<TileKey, RecordedTile, TileKeyHash> tiles;
  std::vector<RecordedPose> poses;            ///< in order; at least one
  intensity::RingHistograms rings;            ///< from which the scale of the tiles' intensities was made
  std::size_t bytes = 0;                      ///< of the file that holds it, without a batch that was cut short
  std::optional<RecordedLocalMap> local_map;  ///< from a file beside it; nothing if that is not of this drive and epoch
};

/// Drops the poses later than `utime`, us, but never the first one.
inline void drop_poses_after(std::int64_t utime, std::vector<RecordedPose>& poses) {
  if (poses.empty()) return;
  poses.erase(
      std::find_if(poses.begin() + 1, poses.end(), [&](const RecordedPose& pose) { return pose.utime > utime; }),
      poses.end());
}

/// One line that names the file and the fault.
class JournalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace curbstone::mapper::journal
