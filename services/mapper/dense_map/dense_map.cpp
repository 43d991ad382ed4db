#include "services/mapper/dense_map/dense_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace curbstone::mapper::dense_map {
namespace {

constexpr std::int64_t kPendingTimeout = 3'000'000;  // us without a hit, after which a pending voxel is dropped
constexpr double kGroundSlope = 0.05;                // rate at which unseen ground may rise above the vehicle's plane
constexpr std::int64_t kHousekeeping = 64;           // scans between
constexpr std::uint32_t kHeldEvery = 4;              // scans between tests of a held voxel
constexpr std::size_t kShareByScan = 16;     // divisor: share of the sleeping tiles that is spilled with each scan
constexpr int kFreeSpacePeriod = 4;          // scans between free-space tests of a tile
constexpr std::int64_t kDoubt = 10'000'000;  // us for which what was added behind the vehicle may turn out to be gone
constexpr std::int64_t kMinRemovalInterval = 1'000'000;          // us: subscribers recount such a tile's votes
constexpr double kMaxCoordinate = 90'000;                        // m from the start, in either axis
constexpr std::size_t kTogether = PersistenceFilter::kTogether;  // voxels that are looked up together
constexpr int kMaxStep = 32000;                                  // of a point from its tile's origin, up or down
constexpr std::size_t kMaxMovedAtOnce = 300'000;                 // points, within the delay that a pose allows,
constexpr std::size_t kMaxMovedPerScan = 100'000;                // and within the time of a scan

/// tile_at() of a point within the limits of the map.
std::optional<TileKey> mapped_tile_at(const Eigen::Vector3d& p) {
  if (!(std::abs(p.x()) < kMaxCoordinate && std::abs(p.y()) < kMaxCoordinate)) return std::nullopt;
  return TileKey{voxels::floor_to_int(p.x() / kTileSize), voxels::floor_to_int(p.y() / kTileSize)};
}

std::optional<TilePoint> point_in_tile(const Eigen::Vector3d& offset, std::uint8_t intensity) {
  const double z = offset.z() / kPositionStep;
  if (!(std::abs(z) < kMaxStep)) return std::nullopt;
  const auto in_plane = [](double v) {
    return static_cast<std::int16_t>(std::clamp(static_cast<int>(v / kPositionStep), 0, kStepsPerTile - 1));
  };
  return TilePoint{in_plane(offset.x()), in_plane(offset.y()), static_cast<std::int16_t>(voxels::floor_to_int(z)),
                   intensity};
}

void sort_and_unite(std::vector<TileKey>& keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

/// Key of a pending voxel in pending_index_. Not a lattice cell, but equally unique.
voxels::VoxelKey pending_key(TileKey tile, std::uint32_t voxel) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(tile.x) & 0xffff) << 48) |
         (static_cast<std::uint64_t>(static_cast<std::uint32_t>(tile.y) & 0xffff) << 32) | voxel;
}

}  // namespace

DenseMap::DenseMap(const config::DenseConfig& config, std::shared_ptr<SpillFile> spill_file)
    : config_(config),
      voxel_steps_(static_cast<int>(std::lround(config.voxel / kPositionStep))),
      settle_us_(std::llround(1e6 * config.settle_s)),
      spill_file_(std::move(spill_file)),
      tiles_(no_tiles()),
      places_(std::llround(1e6 * config.persistence_s)),
      free_space_(config.ground_clearance) {}

std::vector<TileKey> DenseMap::insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                                      std::int64_t utime, bool add_new) {
  ++round_;
  base_ = T_map_base.translation();
  up_ = T_map_base.linear().col(2);
  learn(points, T_map_base, utime);
  hit_all(utime, add_new);
  std::vector<TileKey> grown = settle_all(utime, Which::kDue);
  if (is_moving()) {
    move_some(kMaxMovedPerScan, grown);
    sort_and_unite(grown);
  }
  if (round_ % kHousekeeping == 0) {
    places_.forget_before(utime - 2 * kPendingTimeout);  // pending voxels there have been dropped before
    bound_memory();
  }
  tiles_.spill(kShareByScan);
  return grown;
}

std::vector<TileKey> DenseMap::finish() {
  std::vector<TileKey> changed;
  move_rest(changed);
  const std::vector<TileKey> settled = settle_all(0, Which::kAll);
  changed.insert(changed.end(), settled.begin(), settled.end());
  sort_and_unite(changed);
  return changed;
}

std::vector<TileKey> DenseMap::clear_free_space(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                                                const Pose& T_base_lidar, const scan::Twist& motion, std::int64_t utime,
                                                const std::function<bool(std::int32_t)>& in_place) {
  std::vector<TileKey> changed;
  const Pose T_map_lidar = T_map_base * T_base_lidar;
  const Eigen::Vector2d here = T_map_lidar.translation().head<2>();
  const double far = std::max(config_.free_range, config_.max_range);
  const auto low = mapped_tile_at({here.x() - far, here.y() - far, 0});
  const auto high = mapped_tile_at({here.x() + far, here.y() + far, 0});
  if (!(config_.free_range > 0) || !low || !high) return changed;
  const Pose T_lidar_map = T_map_lidar.inverse();
  const RangeImage image(points, T_base_lidar, motion);
  const Eigen::Vector2d ahead = T_map_base.linear().col(0).head<2>();
  for (int x = low->x; x <= high->x; ++x) {
    for (int y = low->y; y <= high->y; ++y) {
      if ((x + 3 * y + round_) % kFreeSpacePeriod != 0) continue;
      const Eigen::Vector2d offset = kTileSize * Eigen::Vector2d(x + 0.5, y + 0.5) - here;
      const bool is_near = offset.cwiseAbs().maxCoeff() < config_.free_range + 0.5 * kTileSize;
      DenseTile* const tile = is_near || offset.dot(ahead) < 0 ? tiles_.wake({x, y}) : nullptr;
      if (tile == nullptr || (!is_near && utime - tile->raised_at() > kDoubt)) continue;
      const FreeSpace::View view{image, T_lidar_map, is_near ? config_.free_range : far, in_place};
      const Eigen::Vector3d corner = corner_of({x, y}, *tile);
      std::vector<std::uint32_t> gone =
          is_near ? free_space_.find_removed(*tile, corner, view) : free_space_.find_left_behind(*tile, corner, view);
      if (remove(*tile, std::move(gone), utime)) changed.push_back({x, y});
    }
  }
  return changed;
}

/// Removes these records' points, unless the tile's last removal was a moment ago. Returns whether it did.
bool DenseMap::remove(DenseTile& tile, std::vector<std::uint32_t> gone, std::int64_t utime) {
  if (gone.size() == tile.num_points() && !gone.empty()) gone.pop_back();  // a published tile must not become empty
  if (gone.empty() || utime - tile.removed_at() < kMinRemovalInterval) return false;
  tile.remove(gone, utime);
  const auto count = static_cast<std::int64_t>(gone.size());
  size_ -= count;
  num_removals_ += count;
  counters_.add("dense.removed", count);
  return true;
}

/// First pass over the scan: the lowest point of each column, then what stands above it.
void DenseMap::learn(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base, std::int64_t utime) {
  in_range_.clear();
  const auto z_origin = static_cast<std::int32_t>(std::lround(base_.z()));
  for (const scan::LidarPoint& point : points) {
    const Eigen::Vector3d p = point.position.cast<double>();
    if (p.head<2>().squaredNorm() > config_.max_range * config_.max_range) continue;
    if (!(p.z() > config_.min_height && p.z() < config_.max_height)) continue;
    const Eigen::Vector3d in_map = T_map_base * p;
    const auto key = mapped_tile_at(in_map);
    if (!key) continue;
    DenseTile* const at_key = tiles_.wake_or_make(*key, z_origin);
    if (at_key == nullptr) continue;
    DenseTile& tile = *at_key;
    const std::uint8_t intensity = scale_ ? scale_->of(point.ring, point.intensity) : point.intensity;
    const auto in_tile = point_in_tile(in_map - corner_of(*key, tile), intensity);
    in_range_.push_back({in_map, *key, &tile, in_tile, in_tile ? tile.voxel_number(*in_tile) : 0});
    const auto place = [](double along) {
      return std::clamp(static_cast<int>(along * DenseTile::kColumnsPerMetre), 0, DenseTile::kColumns - 1);
    };
    float& lowest = tile.lowest(place(in_map.x() - key->x * kTileSize), place(in_map.y() - key->y * kTileSize));
    lowest = std::min(lowest, static_cast<float>(in_map.z()));
  }
  high_.clear();
  for (const Seen& seen : in_range_) {
    if (seen.position.z() > ground_at(seen.position) + config_.ground_clearance) high_.push_back(seen.position);
  }
  places_.add_hits(high_, utime);
}

/// The lowest known point in the four columns around, limited by the height that the vehicle's own plane allows for
/// ground: under a vehicle that hides the ground, the lowest point seen belongs to the vehicle.
double DenseMap::ground_at(const Eigen::Vector3d& point) {
  const Eigen::Vector2d d = (point - base_).head<2>();
  const double slope = up_.z() > 0.5 ? -(up_.head<2>().dot(d)) / up_.z() : 0.0;
  return std::min(base_.z() + slope + kGroundSlope * d.norm(), tiles_.lowest_about(point));
}

/// Most points are in voxels that already have one: look-ups are scattered in memory, and little is computed for each.
/// Each step of the search fetches what the next one reads.
void DenseMap::hit_all(std::int64_t utime, bool add_new) {
  struct Open {
    const Seen* seen;
    voxels::VoxelKey name;
    std::uint32_t at;
  };
  std::array<Open, kTogether> open;
  for (std::size_t begin = 0; begin < in_range_.size(); begin += kTogether) {
    const auto now = std::span<const Seen>(in_range_).subspan(begin, std::min(kTogether, in_range_.size() - begin));
    for (const Seen& seen : now) {
      if (seen.in_tile) __builtin_prefetch(seen.tile->begin_of_search(seen.voxel));
    }
    std::size_t size = 0;
    for (const Seen& seen : now) {
      if (!seen.in_tile || seen.tile->occupied(seen.voxel)) continue;
      open[size] = {&seen, pending_key(seen.key, seen.voxel), voxels::FlatIndex::kNone};
      __builtin_prefetch(pending_index_.begin_of_search(open[size++].name));
    }
    for (std::size_t i = 0; i < size; ++i) {
      open[i].at = pending_index_.find(open[i].name);
      if (open[i].at != voxels::FlatIndex::kNone) __builtin_prefetch(&pending_[open[i].at], 1);
    }
    for (std::size_t i = 0; i < size; ++i) hit(*open[i].seen, open[i].name, open[i].at, utime, add_new);
  }
}

/// A hit in a voxel without a point. `at`: its entry in pending_, if it had one a few hits before.
void DenseMap::hit(const Seen& seen, voxels::VoxelKey name, std::uint32_t at, std::int64_t utime, bool add_new) {
  if (at == voxels::FlatIndex::kNone) at = pending_index_.find(name);
  if (at == voxels::FlatIndex::kNone) {
    if (!add_new || tiles_.known_beside(seen.key, *seen.tile, *seen.in_tile)) return;
    at = new_pending();
    pending_index_.find_or_insert(name, at);
    pending_[at] = {.tile = seen.key, .voxel = seen.voxel, .first = utime};
  }
  PendingVoxel& pending = pending_[at];
  pending.last = utime;
  if (pending.hits >= config_.settle_hits) return;  // the point is complete; only the proof that it stays is missing
  ++pending.hits;
  pending.lit += seen.in_tile->intensity > 0 ? 1 : 0;
  pending.intensity += seen.in_tile->intensity;
  pending.sum += Eigen::Vector3i(seen.in_tile->x, seen.in_tile->y, seen.in_tile->z);
}

std::uint32_t DenseMap::new_pending() {
  if (free_.empty()) {
    pending_.emplace_back();
    return static_cast<std::uint32_t>(pending_.size() - 1);
  }
  const std::uint32_t at = free_.back();
  free_.pop_back();
  return at;
}

bool DenseMap::is_due(const PendingVoxel& pending, std::int64_t utime, Which which) const {
  if (which == Which::kAll) return true;
  if (pending.hits < config_.settle_hits && utime - pending.first < settle_us_) return false;
  // Held voxels are tested in turn, because no place counts as static before a second anyway.
  return !pending.held || (static_cast<std::uint32_t>(round_) + pending.voxel) % kHeldEvery == 0;
}

/// The point of a pending voxel, which is held from here on.
DenseMap::Due DenseMap::due(std::uint32_t at) {
  PendingVoxel& pending = pending_[at];
  pending.held = true;
  Due due{at, tiles_.wake(pending.tile), {}, Eigen::Vector3d::Zero()};
  if (due.tile == nullptr) return due;
  const auto mean = [&](int sum) {  // rounded down, so that it stays inside the voxel
    return static_cast<std::int16_t>(sum >= 0 ? sum / pending.hits : -((-sum + pending.hits - 1) / pending.hits));
  };
  due.point = {mean(pending.sum.x()), mean(pending.sum.y()), mean(pending.sum.z()),
               static_cast<std::uint8_t>(pending.intensity / std::max(pending.lit, 1))};
  due.in_map =
      corner_of(pending.tile, *due.tile) + kPositionStep * Eigen::Vector3d(due.point.x, due.point.y, due.point.z);
  return due;
}

/// Adds the voxel's point to the map, or drops it. Returns false if the voxel stays pending.
bool DenseMap::settle(const Due& due, bool may_move, std::int64_t utime, Which which) {
  if (due.tile == nullptr) return true;
  const PendingVoxel& pending = pending_[due.at];
  if (may_move) {
    const bool give_up = which == Which::kAll || utime - pending.last > kPendingTimeout;
    if (give_up) counters_.add("dense.transient");
    return give_up;
  }
  due.tile->append(due.point, which == Which::kAll ? pending.last : utime, anchor_);
  if (due.point.intensity == 0) counters_.add("dense.without_intensity");
  ++size_;
  return true;
}

std::vector<TileKey> DenseMap::settle_all(std::int64_t utime, Which which) {
  due_.clear();
  for (std::size_t i = 0; i < pending_.size(); ++i) {
    if (pending_[i].hits > 0 && is_due(pending_[i], utime, which)) due_.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<TileKey> grown;
  std::array<Due, kTogether> together;
  std::array<PersistenceFilter::Suspect, kTogether> suspects;
  std::array<bool, kTogether> may_move{};
  for (std::size_t begin = 0; begin < due_.size(); begin += kTogether) {
    const std::size_t size = std::min(kTogether, due_.size() - begin);
    for (std::size_t i = 0; i < size; ++i) {
      together[i] = due(due_[begin + i]);
      const PendingVoxel& pending = pending_[together[i].at];
      __builtin_prefetch(pending_index_.begin_of_search(pending_key(pending.tile, pending.voxel)));
      const Eigen::Vector3d& point = together[i].in_map;
      suspects[i] = {point, pending.last, point.z() > ground_at(point) + config_.ground_clearance};
    }
    places_.may_move(std::span(suspects.data(), size), may_move);
    for (std::size_t i = 0; i < size; ++i) {
      PendingVoxel& pending = pending_[together[i].at];
      const std::int64_t before = size_;
      if (!settle(together[i], may_move[i], utime, which)) continue;
      if (size_ != before && suspects[i].is_high) together[i].tile->set_raised_at(utime);
      if (size_ != before && (grown.empty() || grown.back() != pending.tile)) grown.push_back(pending.tile);
      pending_index_.erase(pending_key(pending.tile, pending.voxel));
      pending.hits = 0;
      free_.push_back(together[i].at);
    }
  }
  sort_and_unite(grown);
  return grown;
}

void DenseMap::discard_pending() {
  pending_.clear();
  free_.clear();
  pending_index_.clear(4096);
  places_.clear();
}

void DenseMap::move(const std::vector<Pose>& corrections) {
  std::vector<TileKey> moved;  // discarded: all tiles are replaced, and callers take keys()
  move_rest(moved);            // of an earlier correction
  mover_ = TileMover(std::exchange(tiles_, no_tiles()), corrections, base_);
  discard_pending();
  size_ = num_removals_ = 0;
  move_some(kMaxMovedAtOnce, moved);
}

void DenseMap::move_some(std::size_t most, std::vector<TileKey>& grown) {
  mover_.move(most, [&](const MovedPoint& point) {
    const auto key = put(point);
    if (key && (grown.empty() || grown.back() != *key)) grown.push_back(*key);
  });
  (void)tiles_.sleep_beyond(base_, config_.max_range + config_.awake);  // bounds the number of awake tiles
}

void DenseMap::move_rest(std::vector<TileKey>& grown) {
  while (is_moving()) {
    move_some(kMaxMovedAtOnce, grown);
    tiles_.spill(kAllAtOnce);
  }
}

/// Adds a moved point. Returns its tile; nothing if its voxel is occupied, or if it lies outside the map or tile.
std::optional<TileKey> DenseMap::put(const MovedPoint& point) {
  const auto key = mapped_tile_at(point.position);
  if (!key) return std::nullopt;
  DenseTile* const at_key = tiles_.wake_or_make(*key, point.z_origin);
  if (at_key == nullptr) return std::nullopt;
  DenseTile& tile = *at_key;
  const auto in_tile = point_in_tile(point.position - corner_of(*key, tile), point.intensity);
  if (!in_tile || tile.occupied(tile.voxel_number(*in_tile))) return std::nullopt;
  tile.append(*in_tile, point.utime, point.anchor);
  ++size_;
  float& lowest = tile.lowest_at(*in_tile);
  lowest = std::min(lowest, static_cast<float>(point.position.z()));
  return key;
}

}  // namespace curbstone::mapper::dense_map
