#include <utility>

#include "services/mapper/dense_map/dense_map.hpp"

/// @file
/// DenseMap: tiles from other sources, evicted tiles, and memory.

namespace curbstone::mapper::dense_map {

/// Spilled records need no bound here, as the disk has its own; records that wait to be written are kept only until
/// then.
void DenseMap::bound_memory() {
  std::vector<TileKey> far = tiles_.sleep_beyond(base_, config_.max_range + config_.awake);
  std::int64_t here = size_ + 2 * num_removals_;
  if (here <= config_.max_points || spill_file_->takes()) return;
  std::erase_if(far, [&](TileKey key) {
    const DenseTile& tile = *tiles_.find(key);
    if (!tile.is_in_file()) return false;
    here -= static_cast<std::int64_t>(tile.num_records());
    return true;
  });
  for (; here > config_.max_points && !far.empty(); far.pop_back()) {
    const DenseTile& tile = *tiles_.find(far.back());
    here -= static_cast<std::int64_t>(tile.num_records());
    size_ -= static_cast<std::int64_t>(tile.num_points());
    num_removals_ -= static_cast<std::int64_t>(tile.num_removals());
    tiles_.evict(far.back());
    evicted_.push_back(far.back());
    counters_.add("dense.evicted_tiles");
  }
}

std::size_t DenseMap::bytes() const {
  std::size_t bytes = 0;
  tiles_.for_each([&](const DenseTile& tile) { bytes += sizeof tile + tile.bytes(); });
  return bytes;
}

void DenseMap::roll_back(std::int64_t utime) {
  std::vector<TileKey> moved;
  move_rest(moved);
  discard_pending();
  size_ = num_removals_ = 0;
  tiles_.truncate_after(utime);
  tiles_.for_each([&](const DenseTile& tile) {
    size_ += static_cast<std::int64_t>(tile.num_points());
    num_removals_ += static_cast<std::int64_t>(tile.num_removals());
  });
}

void DenseMap::load(TileKey key, std::int32_t z_origin, std::int64_t utime, const std::vector<TilePoint>& points) {
  DenseTile* const at_key = tiles_.wake_or_make(key, z_origin);
  if (at_key == nullptr) return;
  DenseTile& tile = *at_key;
  for (const TilePoint& p : points) {
    if (tile.occupied(tile.voxel_number(p))) continue;
    tile.append(p, utime, kFixed);
    ++size_;
  }
  tiles_.sleep(key);
  tiles_.spill(kAllAtOnce);
  spill_file_->flush_much();
}

/// A tile that was far from the vehicle, or belongs to an earlier drive, is restored asleep.
void DenseMap::restore(TileKey key, std::int32_t z_origin, TileRecords records, const Eigen::Vector3d& at) {
  const bool is_near = distance_of(key, at) < config_.max_range + config_.awake;
  const bool is_fixed = !records.runs.empty() && records.runs.front().anchor == kFixed;
  DenseTile* const at_key = tiles_.wake_or_make(key, z_origin);
  if (at_key == nullptr) return;
  DenseTile& tile = *at_key;
  const bool is_awake = is_near && !is_fixed;
  if (!is_awake) tiles_.sleep(key);
  tile.restore(std::move(records));
  size_ += static_cast<std::int64_t>(tile.num_points());
  num_removals_ += static_cast<std::int64_t>(tile.num_removals());
  tiles_.spill(kAllAtOnce);
  spill_file_->flush_much();
}

std::vector<TileKey> DenseMap::take_evicted() {
  return std::exchange(evicted_, {});
}

}  // namespace curbstone::mapper::dense_map
