#pragma once

#include <cstdint>
#include <memory>
#include <optional>
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

/// The dense map in tiles. A voxel gives one point: the mean of its first hits. Points clear of the ground wait until
/// their place has been seen occupied for a while, so that moving objects leave no trail, and so do low points under
/// them. Points that beams later pass through are removed. In a tile that is known from an earlier visit a point goes
/// in only where nothing is known beside it; else noise would make surfaces thicker with each visit. The intensity of a
/// point is the mean over those hits that had one, on the scale of set_scale(); 0: none had. A function of the calls
/// alone; one thread.
///
/// Tiles far from the vehicle sleep, and the records of those that have slept for longest lie in a file: see
/// DenseTile::read(). So memory does not grow with the drive, but for some hundred bytes a tile. Where no file takes
/// them, `max_points` bounds what memory holds, and the farthest tiles are given up, as take_evicted() tells. To
/// a tile that the file does not give back nothing is added, and nothing taken out: who was sent it has it still, and
/// other records in the same tile would contradict those. move() and roll_back() are the end of it.
///
/// Counters: dense.points, dense.transient (voxels given up: nothing stayed there), dense.removed (points: seen through
/// since), dense.evicted_tiles, dense.without_intensity (points).
class DenseMap {
 public:
  /// `far`: the file; one without a folder keeps them in memory, packed.
  explicit DenseMap(const config::DenseConfig& config, std::shared_ptr<SpillFile> far = std::make_shared<SpillFile>());

  /// Takes a registered scan; `points` in base_link. `add_new` false: hits count only in voxels that are waiting
  /// already. Returns the tiles that grew, in order.
  std::vector<TileKey> insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, std::int64_t utime,
                              bool add_new = true);
  /// Takes out what the same scan's beams passed through, now and before: see FreeSpace. `motion`: of base_link
  /// during it; `in_place`: whether an anchor's points are where they are seen, or may be displaced by drift. Looks at
  /// a part of the surroundings each time. Returns the tiles that changed, in order.
  std::vector<TileKey> look_through(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                                    const Pose& T_base_lidar, const scan::Twist& motion, std::int64_t utime,
                                    const std::function<bool(std::int32_t)>& in_place);
  /// The node of the drive that the vehicle is at: what is settled from now on moves with it.
  void set_anchor(std::int32_t anchor) { anchor_ = anchor; }
  /// Puts the intensities of what is inserted from now on to one scale; nullptr: they are taken as they are.
  void set_scale(std::shared_ptr<const intensity::RingTable> scale) { scale_ = std::move(scale); }
  static constexpr std::int32_t kFixed = -1;  ///< an anchor that never moves

  /// The nodes have been moved: every point goes where its anchor's correction, T_new_old by number, takes it. Where
  /// two come into one voxel, one stays. What still waited is forgotten. All tiles are other ones now: those about the
  /// vehicle at once, the others with the scans that follow, whose insert() tells of them.
  void move(const std::vector<Pose>& corrections);
  /// Points are still to be moved: in no tile are they meanwhile. finish() and roll_back() move them first.
  [[nodiscard]] bool is_moving() const { return !mover_.is_done(); }
  /// Forgets what was settled after `utime`, to about a second, and what waits; what was taken out since is there
  /// again.
  void roll_back(std::int64_t utime);
  /// Takes a tile of an earlier map, which moves no more. The key must be new.
  void load(TileKey key, std::int32_t z_origin, std::int64_t utime, const std::vector<TilePoint>& points);
  /// Takes a tile of this drive from who mapped it before; the vehicle is `at` a place (map). The key must be new, the
  /// records and runs must be those of a tile.
  void restore(TileKey key, std::int32_t z_origin, TileRecords records, const Eigen::Vector3d& at);

  /// What is still waiting for more hits goes in as it is; what must prove that it stays, does not.
  std::vector<TileKey> finish();

  /// nullptr if there is none. Lives until the next insert().
  [[nodiscard]] const DenseTile* tile(TileKey key) const { return tiles_.find(key); }
  /// Of all tiles, in order.
  [[nodiscard]] std::vector<TileKey> keys() const { return tiles_.keys(); }
  /// Tiles that were given up for memory since the last call.
  [[nodiscard]] std::vector<TileKey> take_evicted();
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// Memory of all tiles, but for what is away.
  [[nodiscard]] std::size_t bytes() const;
  /// Points that were taken out and that the tiles still tell of; move() makes them lists of points alone.
  [[nodiscard]] std::int64_t num_removals() const { return num_removals_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// A point of the running scan.
  struct Seen {
    Eigen::Vector3d position;  // m, map
    TileKey key;
    DenseTile* tile;
    std::optional<TilePoint> in_tile;  // nothing: too high or too low for its tile
    std::uint32_t voxel;               // DenseTile::voxel_number
  };
  /// A voxel that has been hit and has no point yet; not one when `hits` is 0.
  struct Waiting {
    TileKey tile;
    std::uint32_t voxel = 0;  // DenseTile::voxel_number
    bool held = false;        // has had its time, must prove that it stays
    std::int32_t hits = 0;
    std::int32_t lit = 0;                           // hits that had an intensity,
    std::int32_t intensity = 0;                     // and its sum
    Eigen::Vector3i sum = Eigen::Vector3i::Zero();  // of TilePoint positions
    std::int64_t first = 0;                         // us
    std::int64_t last = 0;                          // us
  };
  void learn(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, std::int64_t utime);
  void prefetch(const Seen& seen) const;
  void hit(const Seen& seen, std::int64_t utime, bool add_new);
  [[nodiscard]] std::uint32_t new_waiting();
  [[nodiscard]] double ground_at(const Eigen::Vector3d& point);
  [[nodiscard]] bool may_be_moving(const Eigen::Vector3d& point, std::int64_t utime);
  [[nodiscard]] bool settle(Waiting& waiting, std::int64_t utime, bool last_call);
  std::vector<TileKey> settle_all(std::int64_t utime, bool last_call);
  void forget_waiting();
  void move_some(std::size_t most, std::vector<TileKey>& grown);
  void move_rest(std::vector<TileKey>& grown);
  std::optional<TileKey> put(const MovedPoint& point);
  [[nodiscard]] TileGrid no_tiles() const {
    return {voxel_steps_, far_, static_cast<std::size_t>(config_.asleep_here)};
  }
  void bound_memory();
  static constexpr std::size_t kAllAtOnce = 1;  // share of the tiles that are put away, where nobody waits

  config::DenseConfig config_;
  int voxel_steps_;
  std::int64_t settle_us_;
  std::shared_ptr<SpillFile> far_;
  TileGrid tiles_;
  TileMover mover_;  // of what is still to be moved into them
  std::vector<Waiting> waiting_;
  voxels::FlatIndex waiting_index_;
  std::vector<std::uint32_t> free_;  // of waiting_
  PersistenceFilter places_;
  FreeSpace free_space_;
  std::vector<TileKey> evicted_;
  std::vector<Seen> in_range_;                      // scratch
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
