#include "services/viewer/store/dense_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace curbstone::viewer::store {
namespace {

constexpr std::int32_t kMaxListed = 65'000;  // points in a tile's list whose tensors are kept; 130 kB
constexpr float kCoarse = 0.3F;              // m: the scale of the curbs, as semantic_map takes it

std::uint32_t voxel_of(int x, int y, int z) {
  constexpr int kAside = kStepsPerTile / DenseCloud::kVoxel;
  const int level = (z - std::numeric_limits<std::int16_t>::min()) / DenseCloud::kVoxel;
  return static_cast<std::uint32_t>((level * kAside + y / DenseCloud::kVoxel) * kAside + x / DenseCloud::kVoxel);
}

bool is_inside(int x, int y) {
  return x >= 0 && x < kStepsPerTile && y >= 0 && y < kStepsPerTile;
}

bool is_sound(const map_points_t& message) {
  const auto n = static_cast<std::size_t>(std::max(0, message.num_points));
  const std::int64_t end = std::int64_t{message.first} + message.num_points;
  const bool agrees = message.first >= 0 && message.num_points >= 0 &&
                      end <= std::numeric_limits<std::int32_t>::max() && std::isfinite(message.z_origin) &&
                      message.x.size() == n && message.y.size() == n && message.z.size() == n &&
                      message.intensity.size() == n;
  if (!agrees) return false;
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_inside(message.x[i] < 0 ? -1 - message.x[i] : message.x[i], message.y[i])) return false;
  }
  return true;
}

bool is_sound(const voted_points_t& message) {
  const std::size_t n = message.x.size();
  const auto are = [](std::int64_t size, const auto&... lists) {
    return ((static_cast<std::int64_t>(lists.size()) == size) && ...);
  };
  const bool agrees =
      message.revision >= 1 && message.base >= 0 && message.first >= 0 && message.num_scales >= 1 &&
      std::int64_t{message.first} + message.num_points <= message.total &&
      message.num_voters == std::int64_t{message.num_scales} * message.num_points && std::isfinite(message.z_origin) &&
      are(message.num_points, message.x, message.y, message.z, message.intensity) &&
      are(message.num_scales, message.sigma) && are(message.num_voters, message.voter) &&
      are(message.num_tensors, message.point, message.scale, message.stick, message.plate, message.mass);
  if (!agrees) return false;
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_inside(message.x[i], message.y[i])) return false;
  }
  const auto is_listed = [&](std::int32_t index) { return index >= 0 && index < message.total; };
  return std::all_of(message.voter.begin(), message.voter.end(), is_listed) &&
         std::all_of(message.point.begin(), message.point.end(), is_listed);
}

std::size_t coarse_scale(const std::vector<float>& sigma) {
  const auto off = [](float s) { return std::isfinite(s) ? std::abs(s - kCoarse) : 1e9F; };
  const auto best = std::min_element(sigma.begin(), sigma.end(), [&](float a, float b) { return off(a) < off(b); });
  return static_cast<std::size_t>(best - sigma.begin());
}

std::uint8_t known(std::uint8_t share) {
  return std::max<std::uint8_t>(1, share);
}

}  // namespace

std::vector<TileKey> DenseCloud::look(std::int32_t epoch, std::vector<Place> places) {
  if (epoch != epoch_) clear();
  epoch_ = epoch;
  places_ = std::move(places);
  std::vector<TileKey> gone;
  std::erase_if(tiles_, [&](const auto& entry) {
    if (is_near(entry.first)) return false;
    gone.push_back(entry.first);
    return true;
  });
  return gone;
}

void DenseCloud::clear() {
  tiles_.clear();
}

bool DenseCloud::is_near(TileKey key) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    return squared_distance(key, place.x, place.y) <= place.reach * place.reach;
  });
}

DenseCloud::Tile* DenseCloud::tile_for(std::int32_t epoch, TileKey key, float z_origin, Put& why) {
  why = Put::kIgnored;
  if (epoch != epoch_) return nullptr;
  why = Put::kFar;
  if (!is_near(key)) return nullptr;
  why = Put::kIgnored;
  if (tiles_.size() >= kMaxTiles && !tiles_.contains(key)) return nullptr;
  Tile& tile = tiles_[key];
  tile.z_origin = z_origin;
  return &tile;
}

void DenseCloud::add(Tile& tile, const Point& point, std::int32_t voter) {
  if (tile.slots.size() >= kMaxTilePoints) return;
  const auto slot = static_cast<std::uint16_t>(tile.slots.size());
  if (!tile.by_voxel.try_emplace(voxel_of(point.x, point.y, point.z), slot).second) return;
  tile.number = ++number_;
  tile.slots.push_back({point, voter, number_});
}

/// The last point takes the place of the removed one.
void DenseCloud::remove(Tile& tile, const TilePoint& gone) {
  const auto found = tile.by_voxel.find(voxel_of(gone.x, gone.y, gone.z));
  if (found == tile.by_voxel.end()) return;
  Slot& slot = tile.slots[found->second];
  if (slot.point.x != gone.x || slot.point.y != gone.y || slot.point.z != gone.z) return;
  const Slot last = tile.slots.back();
  tile.by_voxel[voxel_of(last.point.x, last.point.y, last.point.z)] = found->second;
  slot = last;
  slot.number = tile.number = ++number_;
  tile.slots.pop_back();
  tile.by_voxel.erase(voxel_of(gone.x, gone.y, gone.z));
}

DenseCloud::Put DenseCloud::put(const map_points_t& message) {
  if (!is_sound(message)) return Put::kRefused;
  Put why{};
  Tile* const tile = tile_for(message.epoch, {message.tile_x, message.tile_y}, message.z_origin, why);
  if (tile == nullptr) return why;
  if (tile->is_voted) return Put::kIgnored;
  const std::int32_t end = message.first + message.num_points;
  const bool has_gap = message.first > tile->version;
  for (std::int32_t at = std::max(message.first, has_gap ? 0 : tile->version); at < end; ++at) {
    const auto i = static_cast<std::size_t>(at - message.first);
    const TilePoint record{message.x[i], message.y[i], message.z[i], message.intensity[i]};
    if (is_removal(record))
      remove(*tile, removal_of(record));
    else
      add(*tile, {record.x, record.y, record.z, record.intensity, 0, 0}, 0);
  }
  if (has_gap) return Put::kGap;
  if (end <= tile->version) return Put::kIgnored;
  tile->version = end;
  return Put::kTaken;
}

/// The list of a tile's points only grows within a chain, so a point or a tensor that comes twice changes nothing.
DenseCloud::Put DenseCloud::put(const voted_points_t& message) {
  if (!is_sound(message)) return Put::kRefused;
  Put why{};
  const TileKey key{message.tile_x, message.tile_y};
  Tile* const tile = tile_for(message.epoch, key, message.z_origin, why);
  if (tile == nullptr) return why;
  if (tile->is_voted && tile->chain == message.chain && message.revision < tile->version) return Put::kIgnored;
  const bool begins = !tile->is_voted || tile->chain != message.chain ||
                      (message.base == 0 && (!tile->is_whole || message.revision > tile->version));
  if (begins) {
    *tile = {};
    tile->z_origin = message.z_origin;
    tile->number = ++number_;
    tile->chain = message.chain;
    tile->is_voted = true;
    tile->is_whole = message.base == 0;
  }
  const bool has_gap = !tile->is_whole || message.base > tile->version;
  if (message.total <= kMaxListed && tile->tensors.size() < static_cast<std::size_t>(message.total))
    tile->tensors.resize(static_cast<std::size_t>(message.total));
  const std::size_t n = message.x.size(), voters = coarse_scale(message.sigma) * n;
  for (std::size_t i = 0; i < n; ++i)
    add(*tile, {message.x[i], message.y[i], message.z[i], message.intensity[i], 0, 0}, message.voter[voters + i]);
  take_tensors(*tile, message);
  if (has_gap) return Put::kGap;
  tile->version = message.revision;
  return Put::kTaken;
}

void DenseCloud::take_tensors(Tile& tile, const voted_points_t& message) {
  const std::size_t scale = coarse_scale(message.sigma);
  for (std::size_t i = 0; i < message.point.size(); ++i) {
    const auto index = static_cast<std::size_t>(message.point[i]);
    if (message.scale[i] != scale || index >= tile.tensors.size() || !(message.mass[i] > 0)) continue;
    tile.tensors[index] = {known(message.stick[i]), known(message.plate[i])};
  }
  // A share that moves by less than the eye sees is not sent again.
  constexpr int kSeen = 6;
  for (Slot& slot : tile.slots) {
    if (static_cast<std::size_t>(slot.voter) >= tile.tensors.size()) continue;
    const auto [surface, line] = tile.tensors[static_cast<std::size_t>(slot.voter)];
    if (surface == 0) continue;
    const bool is_first = slot.point.surface == 0;
    if (!is_first && std::abs(surface - slot.point.surface) < kSeen && std::abs(line - slot.point.line) < kSeen)
      continue;
    slot.point.surface = surface;
    slot.point.line = line;
    slot.number = tile.number = ++number_;
  }
}

}  // namespace curbstone::viewer::store
