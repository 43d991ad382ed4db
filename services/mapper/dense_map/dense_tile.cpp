#include "services/mapper/dense_map/dense_tile.hpp"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "common/tiles/vector_memory.hpp"

namespace curbstone::mapper::dense_map {
namespace {

constexpr std::uint32_t kMark = 1U << 31;

/// Names a place in a tile.
std::uint64_t place_key(const TilePoint& point) {
  return (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.x)) << 32) |
         (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.y)) << 16) | static_cast<std::uint16_t>(point.z);
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

}  // namespace

std::size_t NumberSet::home_of(std::uint32_t number) const {
  return (number * 0x9e3779b1U >> 7) & (slots_.size() - 1);
}

std::size_t NumberSet::place_of(std::uint32_t number) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = home_of(number);
  while (slots_[i] != 0 && (slots_[i] & ~kMark) != number + 1) i = (i + 1) & mask;
  return i;
}

bool NumberSet::contains(std::uint32_t number) const {
  return !slots_.empty() && slots_[place_of(number)] != 0;
}

bool NumberSet::is_marked(std::uint32_t number) const {
  return !slots_.empty() && (slots_[place_of(number)] & kMark) != 0;
}

void NumberSet::insert(std::uint32_t number, bool marked) {
  if (2 * (size_ + 1) > slots_.size()) {
    std::vector<std::uint32_t> old(std::max<std::size_t>(64, 2 * slots_.size()));
    old.swap(slots_);
    for (const std::uint32_t slot : old) {
      if (slot != 0) slots_[place_of((slot & ~kMark) - 1)] = slot;
    }
  }
  std::uint32_t& slot = slots_[place_of(number)];
  if (slot != 0) return;
  ++size_;
  slot = (number + 1) | (marked ? kMark : 0);
}

/// What was put behind the hole moves up, so no search gets longer for it.
void NumberSet::erase(std::uint32_t number) {
  if (!contains(number)) return;
  const std::size_t mask = slots_.size() - 1;
  std::size_t hole = place_of(number);
  for (std::size_t i = (hole + 1) & mask; slots_[i] != 0; i = (i + 1) & mask) {
    if (((i - home_of((slots_[i] & ~kMark) - 1)) & mask) < ((i - hole) & mask))
      continue;  // its home is behind the hole
    slots_[hole] = slots_[i];
    hole = i;
  }
  slots_[hole] = 0;
  --size_;
}

DenseTile::DenseTile(std::int32_t z_origin, int voxel_steps) : z_origin_(z_origin), voxel_steps_(voxel_steps) {
  index_points();
}

std::uint32_t DenseTile::voxel_number(const TilePoint& point) const {
  const int per_side = kStepsPerTile / voxel_steps_;
  const int floor_steps = (32768 / voxel_steps_ + 1) * voxel_steps_;  // below every int16, on the lattice through 0
  const int layer = (point.z + floor_steps) / voxel_steps_;
  return static_cast<std::uint32_t>((layer * per_side + point.y / voxel_steps_) * per_side + point.x / voxel_steps_);
}

void DenseTile::append_record(const TilePoint& record, std::int64_t utime, std::int32_t anchor) {
  constexpr std::int64_t kLongestRun = 1'000'000;  // us: what cut_after() can tell apart
  if (runs_.empty() || runs_.back().anchor != anchor || std::abs(utime - runs_.back().utime) > kLongestRun) {
    runs_.push_back({anchor, static_cast<std::int32_t>(records_.size()), utime});
  }
  utime_ = std::max(utime_, utime);
  make_room(1, records_);
  records_.push_back(record);
}

void DenseTile::append(const TilePoint& point, std::int64_t utime, std::int32_t anchor) {
  append_record(point, utime, anchor);
  occupied_.insert(voxel_number(point));
  make_room(1, seen_through_);
  seen_through_.push_back(0);
}

void DenseTile::remove(const std::vector<std::uint32_t>& records, std::int64_t utime) {
  for (const std::uint32_t record : records) {
    const TilePoint point = records_[record];
    append_record(removal_of(point), utime, runs_.back().anchor);
    occupied_.erase(voxel_number(point));
    seen_through_[record] = kGone;
    seen_through_.push_back(kGone);
    ++num_removals_;
  }
  removed_at_ = utime;
}

std::vector<bool> DenseTile::standing() const {
  std::vector<bool> there(records_.size(), true);
  if (num_removals_ == 0) return there;
  std::unordered_map<std::uint64_t, std::size_t> at;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (!is_removal(records_[i])) {
      at[place_key(records_[i])] = i;
      continue;
    }
    there[i] = false;
    there[at.at(place_key(removal_of(records_[i])))] = false;
  }
  return there;
}

std::vector<TilePoint> DenseTile::points() const {
  const std::vector<bool> there = standing();
  std::vector<TilePoint> points;
  points.reserve(num_points());
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (there[i]) points.push_back(records_[i]);
  }
  return points;
}

void DenseTile::set_vacated(int column) {
  if (vacated_.empty()) vacated_.resize(kVacatedColumns * kVacatedColumns);
  vacated_[static_cast<std::size_t>(column)] = true;
}

void DenseTile::cut_after(std::int64_t utime) {
  std::vector<TilePoint> records;
  std::vector<Run> runs;
  records.swap(records_);
  runs.swap(runs_);
  utime_ = 0;
  num_removals_ = 0;
  std::unordered_set<std::uint64_t> there;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (runs[r].utime > utime) continue;
    runs_.push_back({runs[r].anchor, static_cast<std::int32_t>(records_.size()), runs[r].utime});
    utime_ = std::max(utime_, runs[r].utime);
    const std::size_t end = r + 1 < runs.size() ? static_cast<std::size_t>(runs[r + 1].first) : records.size();
    for (auto i = static_cast<std::size_t>(runs[r].first); i < end; ++i) {
      const TilePoint& record = records[i];
      if (is_removal(record)) {  // after a jump of the clock, of something that came "later"
        if (there.erase(place_key(removal_of(record))) == 0) continue;
        ++num_removals_;
      } else {
        there.insert(place_key(record));
      }
      records_.push_back(record);
    }
  }
  give_back(vacated_);
  if (!asleep_) index_points();
}

void DenseTile::restore(std::vector<TilePoint> records, std::vector<Run> runs, bool awake) {
  records_ = std::move(records);
  runs_ = std::move(runs);
  for (const Run& run : runs_) utime_ = std::max(utime_, run.utime);
  num_removals_ = static_cast<std::size_t>(std::count_if(records_.begin(), records_.end(), is_removal));
  if (awake)
    index_points();
  else
    sleep();
}

float& DenseTile::lowest(int column, int row) {
  return lowest_[static_cast<std::size_t>(row * kColumns + column)];
}

void DenseTile::sleep() {
  if (asleep_) return;
  asleep_ = true;
  records_.shrink_to_fit();
  runs_.shrink_to_fit();
  occupied_ = NumberSet();
  give_back(lowest_);
  give_back(seen_through_);
  give_back(vacated_);
}

std::size_t DenseTile::bytes() const {
  return bytes_of(records_) + bytes_of(runs_) + occupied_.bytes() + bytes_of(lowest_) + bytes_of(seen_through_) +
         vacated_.capacity() / 8;
}

void DenseTile::wake() {
  if (!asleep_) return;
  asleep_ = false;
  has_slept_ = true;
  index_points();
}

void DenseTile::index_points() {
  occupied_ = NumberSet();
  lowest_.assign(kColumns * kColumns, std::numeric_limits<float>::infinity());
  const std::vector<bool> there = standing();
  seen_through_.assign(records_.size(), kGone);
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (!there[i]) continue;
    const TilePoint& point = records_[i];
    seen_through_[i] = 0;
    occupied_.insert(voxel_number(point), has_slept_);
    float& low = lowest(point.x * kColumns / kStepsPerTile, point.y * kColumns / kStepsPerTile);
    low = std::min(low, static_cast<float>(z_origin_ + point.z * kPositionStep));
  }
}

}  // namespace curbstone::mapper::dense_map
