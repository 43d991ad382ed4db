#include "services/mapper/dense_map/persistence_filter.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace curbstone::mapper::dense_map {
namespace {

constexpr double kSize = 0.2;               // m, horizontally
constexpr double kHeight = 0.6;             // m
constexpr std::int64_t kBreak = 1'000'000;  // us without a hit, after which the object has left

Eigen::Vector3i cell_of(const Eigen::Vector3d& p) {
  return {voxels::floor_to_int(p.x() / kSize), voxels::floor_to_int(p.y() / kSize),
          voxels::floor_to_int(p.z() / kHeight)};
}

}  // namespace

void PersistenceFilter::add_hits(std::span<const Eigen::Vector3d> points, std::int64_t utime) {
  std::array<Eigen::Vector3i, kTogether> cells;
  std::array<std::uint32_t, kTogether> at;  // of the block, then of the place
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    const std::size_t size = std::min(kTogether, points.size() - begin);
    for (std::size_t i = 0; i < size; ++i) {
      cells[i] = cell_of(points[begin + i]);
      __builtin_prefetch(index_.begin_of_search(cells[i]));
    }
    for (std::size_t i = 0; i < size; ++i) {
      at[i] = index_.block(cells[i]);
      __builtin_prefetch(index_.address_in(at[i], cells[i]));
    }
    for (std::size_t i = 0; i < size; ++i) {
      at[i] = index_.find_in(at[i], cells[i]);
      if (at[i] != voxels::BlockIndex::kNone) __builtin_prefetch(&places_[at[i]], 1);
    }
    for (std::size_t i = 0; i < size; ++i) add_hit(cells[i], at[i], utime);
  }
}

/// `at`: the cell's place, if it had one a few hits before.
void PersistenceFilter::add_hit(const Eigen::Vector3i& cell, std::uint32_t at, std::int64_t utime) {
  if (at == voxels::BlockIndex::kNone) {
    std::uint32_t& by_now = index_.place(cell);
    if (by_now == voxels::BlockIndex::kNone) {
      by_now = static_cast<std::uint32_t>(places_.size());
      places_.push_back({cell, utime, utime});
      return;
    }
    at = by_now;
  }
  Place& place = places_[at];
  if (utime - place.last > kBreak) place.first = utime;
  place.last = utime;
}

bool PersistenceFilter::is_static(const Eigen::Vector3d& point) const {
  const std::uint32_t at = index_.find(cell_of(point));
  return at != voxels::BlockIndex::kNone && is_static(places_[at]);
}

bool PersistenceFilter::moving_above(const Eigen::Vector3d& point, std::int64_t utime) const {
  voxels::BlockIndex::Finder find(index_);
  const Eigen::Vector3i cell = cell_of(point);
  const int high = voxels::floor_to_int((point.z() + 1.0) / kHeight);
  for (const auto& [dx, dy] : {std::pair{0, 0}, {0, 1}, {0, -1}, {1, 0}, {-1, 0}}) {
    for (int z = cell.z(); z <= high; ++z) {  // mostly beside each other in memory
      const std::uint32_t at = find({cell.x() + dx, cell.y() + dy, z});
      if (at != voxels::BlockIndex::kNone && !is_static(places_[at]) && utime - places_[at].last <= kBreak) return true;
    }
  }
  return false;
}

void PersistenceFilter::may_move(std::span<const Suspect> suspects, std::span<bool> may) const {
  std::array<Eigen::Vector3i, kTogether> cells;
  std::array<std::uint32_t, kTogether> at;  // of the block, then of the place
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    cells[i] = cell_of(suspects[i].point);
    __builtin_prefetch(index_.begin_of_search(cells[i]));
  }
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    at[i] = index_.block(cells[i]);
    __builtin_prefetch(index_.address_in(at[i], cells[i]));
  }
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    at[i] = index_.find_in(at[i], cells[i]);
    if (at[i] != voxels::BlockIndex::kNone) __builtin_prefetch(&places_[at[i]]);
  }
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    const bool is_known = at[i] != voxels::BlockIndex::kNone;
    may[i] = suspects[i].is_high ? !(is_known && is_static(places_[at[i]]))
                                 : moving_above(suspects[i].point, suspects[i].utime);
  }
}

void PersistenceFilter::forget_before(std::int64_t utime) {
  std::erase_if(places_, [&](const Place& place) { return place.last < utime; });
  index_.clear();
  for (std::size_t i = 0; i < places_.size(); ++i) index_.place(places_[i].cell) = static_cast<std::uint32_t>(i);
}

void PersistenceFilter::clear() {
  places_.clear();
  index_.clear();
}

}  // namespace curbstone::mapper::dense_map
