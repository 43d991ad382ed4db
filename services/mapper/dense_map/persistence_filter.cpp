#include "services/mapper/dense_map/persistence_filter.hpp"

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

void PersistenceFilter::add_hit(const Eigen::Vector3d& point, std::int64_t utime) {
  const Eigen::Vector3i cell = cell_of(point);
  std::uint32_t& at = index_.place(cell);
  if (at == voxels::BlockIndex::kNone) {
    at = static_cast<std::uint32_t>(places_.size());
    places_.push_back({cell, utime, utime});
    return;
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
  const int low = voxels::floor_to_int(point.z() / kHeight), high = voxels::floor_to_int((point.z() + 1.0) / kHeight);
  for (int z = low; z <= high; ++z) {
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const std::uint32_t at = find({cell.x() + dx, cell.y() + dy, z});
      if (at != voxels::BlockIndex::kNone && !is_static(places_[at]) && utime - places_[at].last <= kBreak) return true;
    }
  }
  return false;
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
