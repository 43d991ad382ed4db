#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/config/dense_config.hpp"
#include "services/mapper/dense_map/free_space.hpp"
#include "services/mapper/dense_map/persistence_filter.hpp"
#include "services/mapper/dense_map/tile_grid.hpp"
#include "services/mapper/dense_map/tile_mover.hpp"
#include "services/mapper/intensity/ring_table.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::dense_map {

/// The dense map in tiles. A voxel holds one point: the mean of its first hits. Points clear of the ground wait until
/// their place has been occupied for a while, so that moving objects leave no trail; low points under moving objects
/// wait, too. Points that beams later pass through are removed. In a tile that is known from an earlier visit a point
/// is added only where no neighbouring voxel is occupied; otherwise noise would thicken surfaces with each visit. A
/// point's intensity is the mean over the hits that had one, on the scale of set_scale(); 0: no hit had one. A function
/// of the calls alone; one thread.
///
/// Tiles far from the vehicle sleep, and the records of those that have slept for longest are spilled to a file: see
/// DenseTile::read(). So memory grows with the drive by some hundred bytes a tile only. If no file takes them,
/// `max_points` bounds the points in memory, and the farthest tiles are evicted: see take_evicted(). A tile that was
/// evicted, or that the file cannot return, is not changed any more: subscribers still have it, and new records in the
/// same tile would contradict theirs. move() and roll_back() forget such a tile, and it may be mapped again.
///
/// Counters: dense.transient (voxels given up: nothing stayed there), dense.removed (points: seen through since),
/// dense.evicted_tiles, dense.without_intensity (points).
class DenseMap {
 public:
  /// `spill_file`: the file for spilled tiles; one without a folder keeps them in memory, packed.
  explicit DenseMap(const config::DenseConfig& config,
                    std::shared_ptr<SpillFile> spill_file = std::make_shared<SpillFile>());

  /// Adds a registered scan; `points` in base_link. `add_new` false: hits count only in voxels that are pending
  /// already. Returns the tiles that grew, in order.
  std::vector<TileKey> insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, std::int64_t utime,
                              bool add_new = true);
  /// Removes points that the beams of the same scan, with those of earlier ones, passed through: see FreeSpace.
  /// `motion`: of base_link during the scan; `in_place`: whether an anchor's points are at their true place, or may be
  /// displaced by drift. Each call tests a part of the surroundings. Returns the tiles that changed, in order.
  std::vector<TileKey> clear_free_space(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                                        const Pose& T_base_lidar, const scan::Twist& motion, std::int64_t utime,
                                        const std::function<bool(std::int32_t)>& in_place);
  /// Sets the keyframe at the vehicle: points that settle from now on move with it.
  void set_anchor(std::int32_t anchor) { anchor_ = anchor; }
  /// Sets the common intensity scale for the scans inserted from now on; nullptr: intensities are taken unscaled.
  void set_scale(std::shared_ptr<const intensity::RingTable> scale) { scale_ = std::move(scale); }
  static constexpr std::int32_t kFixed = -1;  ///< an anchor that never moves

  /// Applies a correction to the keyframes: each point moves by its anchor's correction, T_new_old by number. If two
  /// points move into one voxel, one is kept. Pending voxels are discarded. All tiles are replaced: those around the
  /// vehicle at once, the others during the following scans, whose insert() reports them.
  void move(const std::vector<Pose>& corrections);
  /// Whether points are still to be moved; until then they are in no tile. finish() and roll_back() move them first.
  [[nodiscard]] bool is_moving() const { return !mover_.is_done(); }
  /// Discards what settled after `utime`, us, to about a second, and all pending voxels. Points removed since then are
  /// restored.
  void roll_back(std::int64_t utime);
  /// Adds a tile of an earlier map, whose points are fixed. The key must be new.
  void load(TileKey key, std::int32_t z_origin, std::int64_t utime, const std::vector<TilePoint>& points);
  /// Adds a tile of this drive from the worker that mapped it before; the vehicle is `at` this place (map, m). The key
  /// must be new, and the records and runs must be those of a tile.
  void restore(TileKey key, std::int32_t z_origin, TileRecords records, const Eigen::Vector3d& at);

  /// Settles all pending voxels as they are, except those that have yet to prove that they stay: these are dropped.
  std::vector<TileKey> finish();

  /// nullptr if there is none. Valid until the next insert().
  [[nodiscard]] const DenseTile* tile(TileKey key) const { return tiles_.find(key); }
  /// Keys of all tiles, in order.
  [[nodiscard]] std::vector<TileKey> keys() const { return tiles_.keys(); }
  /// Tiles that were evicted for memory since the last call.
  [[nodiscard]] std::vector<TileKey> take_evicted();
  /// All tiles that were evicted since the last move() or roll_back().
  [[nodiscard]] const std::unordered_set<TileKey, TileKeyHash>& evicted() const { return tiles_.evicted(); }
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// Memory of all tiles, without what is spilled, in bytes.
  [[nodiscard]] std::size_t bytes() const;
  /// Number of removed points that the tiles still hold records of; move() drops these records.
  [[nodiscard]] std::int64_t num_removals() const { return num_removals_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// A point of the current scan.
  struct Seen {
    Eigen::Vector3d position;  // m, map
    TileKey key;
    DenseTile* tile;
    std::optional<TilePoint> in_tile;  // nothing: too far above or below the tile's origin
    std::uint32_t voxel;               // DenseTile::voxel_number
  };
  /// A voxel with hits and no point yet; an unused entry if `hits` is 0.
  struct PendingVoxel {
    TileKey tile;
    std::uint32_t voxel = 0;  // DenseTile::voxel_number
    bool held = false;        // its point is complete; it must still prove that it stays
    std::int32_t hits = 0;
    std::int32_t lit = 0;                           // hits that had an intensity,
    std::int32_t intensity = 0;                     // and the sum of these intensities
    Eigen::Vector3i sum = Eigen::Vector3i::Zero();  // of TilePoint positions
    std::int64_t first = 0;                         // us
    std::int64_t last = 0;                          // us
  };
  /// A pending voxel that may settle now.
  struct Due {
    std::uint32_t at;  // in pending_
    DenseTile* tile;   // nullptr: it cannot grow
    TilePoint point;
    Eigen::Vector3d in_map;  // m, the same point
  };
  /// Which pending voxels are settled; kAll: the drive is over, so none waits for more hits.
  enum class Which { kDue, kAll };
  [[nodiscard]] bool remove(DenseTile& tile, std::vector<std::uint32_t> gone, std::int64_t utime);
  void learn(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, std::int64_t utime);
  void hit_all(std::int64_t utime, bool add_new);
  void hit(const Seen& seen, voxels::VoxelKey name, std::uint32_t at, std::int64_t utime, bool add_new);
  [[nodiscard]] std::uint32_t new_pending();
  [[nodiscard]] double ground_at(const Eigen::Vector3d& point);
  [[nodiscard]] bool is_due(const PendingVoxel& pending, std::int64_t utime, Which which) const;
  [[nodiscard]] Due due(std::uint32_t at);
  [[nodiscard]] bool settle(const Due& due, bool may_move, std::int64_t utime, Which which);
  std::vector<TileKey> settle_all(std::int64_t utime, Which which);
  void discard_pending();
  void move_some(std::size_t most, std::vector<TileKey>& grown);
  void move_rest(std::vector<TileKey>& grown);
  std::optional<TileKey> put(const MovedPoint& point);
  [[nodiscard]] TileGrid no_tiles() const {
    return {voxel_steps_, spill_file_, static_cast<std::size_t>(config_.asleep_here)};
  }
  void bound_memory();
  static constexpr std::size_t kAllAtOnce = 1;  // divisor of spill(): all sleeping tiles, used where nobody waits

  config::DenseConfig config_;
  int voxel_steps_;
  std::int64_t settle_us_;
  std::shared_ptr<SpillFile> spill_file_;
  TileGrid tiles_;
  TileMover mover_;  // of the points that are still to be moved
  std::vector<PendingVoxel> pending_;
  voxels::FlatIndex pending_index_;
  std::vector<std::uint32_t> free_;  // unused entries of pending_
  PersistenceFilter places_;
  FreeSpace free_space_;
  std::vector<TileKey> evicted_;
  std::vector<Seen> in_range_;                      // scratch
  std::vector<Eigen::Vector3d> high_;               // likewise: positions clear of the ground
  std::vector<std::uint32_t> due_;                  // likewise: entries of pending_
  Eigen::Vector3d base_ = Eigen::Vector3d::Zero();  // position of base_link in map
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();   // its z axis
  std::int64_t round_ = 0;                          // scans inserted
  std::int64_t size_ = 0;                           // points
  std::int64_t num_removals_ = 0;
  std::int32_t anchor_ = kFixed;
  std::shared_ptr<const intensity::RingTable> scale_;
  Counters counters_;
};

}  // namespace curbstone::mapper::dense_map
