#include "services/mapper/dense_map/dense_tile.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "common/tiles/vector_memory.hpp"

namespace curbstone::mapper::dense_map {
namespace {

constexpr std::uint32_t kMark = 1U << 31;

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

void NumberSet::reserve(std::size_t size) {
  std::size_t capacity = 64;
  while (capacity < 2 * size) capacity *= 2;
  if (capacity > slots_.size()) grow(capacity);
}

void NumberSet::grow(std::size_t capacity) {
  std::vector<std::uint32_t> old(capacity);
  old.swap(slots_);
  for (const std::uint32_t slot : old) {
    if (slot != 0) slots_[place_of((slot & ~kMark) - 1)] = slot;
  }
}

void NumberSet::insert(std::uint32_t number, bool marked) {
  if (2 * (size_ + 1) > slots_.size()) grow(std::max<std::size_t>(64, 2 * slots_.size()));
  std::uint32_t& slot = slots_[place_of(number)];
  if (slot != 0) return;
  ++size_;
  slot = (number + 1) | (marked ? kMark : 0);
}

/// Entries behind the hole move up, so that searches do not get longer.
void NumberSet::erase(std::uint32_t number) {
  if (!contains(number)) return;
  const std::size_t mask = slots_.size() - 1;
  std::size_t hole = place_of(number);
  for (std::size_t i = (hole + 1) & mask; slots_[i] != 0; i = (i + 1) & mask) {
    if (((i - home_of((slots_[i] & ~kMark) - 1)) & mask) < ((i - hole) & mask))
      continue;  // its home slot is behind the hole
    slots_[hole] = slots_[i];
    hole = i;
  }
  slots_[hole] = 0;
  --size_;
}

DenseTile::DenseTile(std::int32_t z_origin, int voxel_steps)
    : z_origin_(z_origin),
      per_side_(kStepsPerTile / voxel_steps),
      floor_steps_((32768 / voxel_steps + 1) * voxel_steps),
      inverse_(((std::uint64_t{1} << 32) + static_cast<std::uint64_t>(voxel_steps) - 1) /
               static_cast<std::uint64_t>(voxel_steps)) {
  index_points();
}

void DenseTile::append_record(const TilePoint& record, std::int64_t utime, std::int32_t anchor) {
  constexpr std::int64_t kMaxRun = 1'000'000;  // us: resolution of truncate_after()
  std::vector<Run>& runs = content_.runs;
  if (runs.empty() || runs.back().anchor != anchor || std::abs(utime - runs.back().utime) > kMaxRun) {
    runs.push_back({anchor, static_cast<std::int32_t>(content_.records.size()), utime});
    newest_run_ = std::max(newest_run_, utime);
  }
  utime_ = std::max(utime_, utime);
  make_room(1, content_.records);
  content_.records.push_back(record);
}

void DenseTile::append(const TilePoint& point, std::int64_t utime, std::int32_t anchor) {
  append_record(point, utime, anchor);
  occupied_.insert(voxel_number(point));
  make_room(1, num_passes_);
  num_passes_.push_back(0);
}

void DenseTile::remove(const std::vector<std::uint32_t>& records, std::int64_t utime) {
  for (const std::uint32_t record : records) {
    const TilePoint point = content_.records[record];
    append_record(removal_of(point), utime, content_.runs.back().anchor);
    occupied_.erase(voxel_number(point));
    num_passes_[record] = kRemoved;
    num_passes_.push_back(kRemoved);
    ++num_removals_;
  }
  removed_at_ = utime;
}

std::shared_ptr<const TileRecords> DenseTile::read() const {
  if (!is_spilled_) return {std::shared_ptr<const void>(), &content_};
  try {
    return std::make_shared<const TileRecords>(packed_.read());
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

void DenseTile::set_vacated(int column) {
  if (vacated_.empty()) vacated_.resize(kVacatedColumns * kVacatedColumns);
  vacated_[static_cast<std::size_t>(column)] = true;
}

void DenseTile::set_scans_through(std::size_t column, int scans) {
  if (scans_through_.empty() && scans == 0) return;
  scans_through_.resize(kVacatedColumns * kVacatedColumns);
  scans_through_[column] = static_cast<std::uint8_t>(std::min(scans, 255));
}

bool DenseTile::truncate_after(std::int64_t utime) {
  if (newest_run_ <= utime) {
    utime_ = newest_run_;
    release_memory(vacated_);
    if (!asleep_) index_points();
    return true;
  }
  if (!unspill()) return false;
  packed_ = {};
  const TileRecords old = std::exchange(content_, {});
  utime_ = 0;
  newest_run_ = 0;
  num_removals_ = 0;
  std::unordered_set<std::uint64_t> there;
  for (std::size_t r = 0; r < old.runs.size(); ++r) {
    const Run& run = old.runs[r];
    if (run.utime > utime) continue;
    content_.runs.push_back({run.anchor, static_cast<std::int32_t>(content_.records.size()), run.utime});
    newest_run_ = utime_ = std::max(utime_, run.utime);
    const std::size_t end = old.end_of(r);
    for (auto i = static_cast<std::size_t>(run.first); i < end; ++i) {
      const TilePoint& record = old.records[i];
      if (is_removal(record)) {  // after a clock jump it may remove a point with a later stamp
        if (there.erase(place_key(removal_of(record))) == 0) continue;
        ++num_removals_;
      } else {
        there.insert(place_key(record));
      }
      content_.records.push_back(record);
    }
  }
  release_memory(vacated_);
  if (!asleep_) index_points();
  return true;
}

void DenseTile::restore(TileRecords records) {
  content_ = std::move(records);
  for (const Run& run : content_.runs) newest_run_ = std::max(newest_run_, run.utime);
  utime_ = std::max(utime_, newest_run_);
  num_removals_ = static_cast<std::size_t>(std::count_if(content_.records.begin(), content_.records.end(), is_removal));
  if (!asleep_) index_points();
}

float& DenseTile::lowest(int column, int row) {
  return lowest_[static_cast<std::size_t>(row * kColumns + column)];
}

void DenseTile::sleep() {
  if (asleep_) return;
  asleep_ = true;
  content_.records.shrink_to_fit();
  content_.runs.shrink_to_fit();
  occupied_ = NumberSet();
  release_memory(lowest_);
  release_memory(num_passes_);
  release_memory(vacated_);
  release_memory(scans_through_);
}

/// If no record was added since the tile was read, the file still holds all of them.
bool DenseTile::spill(SpillFile& file) {
  if (!asleep_ || is_spilled_ || content_.records.empty()) return false;
  if (packed_.empty() || num_packed_ != content_.records.size()) {
    packed_ = PackedRecords(content_, file);
    num_packed_ = content_.records.size();
  }
  content_ = {};
  is_spilled_ = true;
  return true;
}

bool DenseTile::unspill() {
  if (!is_spilled_) return true;
  try {
    content_ = packed_.read();
  } catch (const std::runtime_error&) {
    return false;
  }
  is_spilled_ = false;
  return true;
}

std::size_t DenseTile::bytes() const {
  return bytes_of(content_.records) + bytes_of(content_.runs) + occupied_.bytes() + bytes_of(lowest_) +
         bytes_of(num_passes_) + bytes_of(scans_through_) + vacated_.capacity() / 8;
}

bool DenseTile::wake() {
  if (!asleep_) return true;
  read_failed_ = read_failed_ || !unspill();
  if (read_failed_) return false;
  asleep_ = false;
  has_slept_ = true;
  index_points();
  return true;
}

void DenseTile::index_points() {
  occupied_ = NumberSet();
  lowest_.assign(kColumns * kColumns, std::numeric_limits<float>::infinity());
  const std::vector<bool> there = num_removals_ > 0 ? content_.standing() : std::vector<bool>();
  num_passes_.assign(content_.records.size(), kRemoved);
  if (!content_.records.empty()) occupied_.reserve(num_points());
  for (std::size_t i = 0; i < content_.records.size(); ++i) {
    if (num_removals_ > 0 && !there[i]) continue;
    const TilePoint& point = content_.records[i];
    num_passes_[i] = 0;
    occupied_.insert(voxel_number(point), has_slept_);
    float& low = lowest(point.x * kColumns / kStepsPerTile, point.y * kColumns / kStepsPerTile);
    low = std::min(low, static_cast<float>(z_origin_ + point.z * kPositionStep));
  }
}

}  // namespace curbstone::mapper::dense_map
