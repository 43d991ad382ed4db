#include "services/tensor_voting/worker/voted_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curbstone::tensor_voting::worker {

namespace {
constexpr std::int32_t kStepsPerMetre = 500;
constexpr double kUnthinned = 0.05;  // m: voxels of the dense map's default, where every point votes

PointTiles::Limits with_reach(PointTiles::Limits limits, std::span<const voting::VotingParameters> scales) {
  limits.reach = 0;
  for (const voting::VotingParameters& scale : scales)
    limits.reach = std::max(limits.reach, static_cast<int>(std::ceil(scale.radius / kPositionStep)));
  return limits;
}
}  // namespace

std::int64_t most_votes_lost_with_a_point(std::span<const voting::VotingParameters> scales) {
  std::int64_t most = 1;
  for (const voting::VotingParameters& scale : scales) {
    const double voxel = scale.voxel > 0 ? scale.voxel : kUnthinned;
    const double reach = (scale.radius + kPositionStep) / voxel;  // the radius is rounded up to whole steps
    const auto last = static_cast<int>(std::ceil(reach)) + 1;
    const auto gap2 = [](int d) { return std::max(0, std::abs(d) - 1) * std::max(0, std::abs(d) - 1); };
    std::int64_t voters = 0;
    for (int x = -last; x <= last; ++x) {
      for (int y = -last; y <= last; ++y) {
        for (int z = -last; z <= last; ++z) voters += gap2(x) + gap2(y) + gap2(z) < reach * reach ? 1 : 0;
      }
    }
    most += 2 * voters;
  }
  return most;
}

VotedMap::VotedMap(PointTiles::Limits limits, std::span<const voting::VotingParameters> scales)
    : points_(with_reach(limits, scales)), votes_of_a_point_(most_votes_lost_with_a_point(scales)) {
  for (const voting::VotingParameters& scale : scales) fields_.emplace_back(scale);
}

PointTiles::Taken VotedMap::take(const map_points_t& message, bool matters) {
  const TileKey key{message.tile_x, message.tile_y};
  const PointTile* const before = points_.find(key);
  const bool was_voted = before == nullptr || num_voted(key) == before->points.size();
  const PointTiles::Taken taken = points_.take(message);
  if (taken.outcome != PointTiles::Outcome::kAdded) return taken;
  const PointTile& tile = *points_.find(key);
  if (taken.removed) {
    // With exact sums, removing and adding the remaining points gives exactly their votes.
    for (voting::VotingField& field : fields_) field.remove(key);
    for (int i = 0; i < 9; ++i) {
      if (tile.removals[static_cast<std::size_t>(i)] > 0) changed_.insert({key.x + i % 3 - 1, key.y + i / 3 - 1});
    }
    if (!matters || !was_voted) return taken;  // it still waits to be added
    for (voting::VotingField& field : fields_) field.add(key, tile.z_origin * kStepsPerMetre, tile.points);
    return taken;
  }
  if (!matters) return taken;
  // A tile that still waits to be added gets these points then.
  if (num_voted(key) + taken.added.size() != tile.points.size()) return taken;
  for (voting::VotingField& field : fields_) field.add(key, tile.z_origin * kStepsPerMetre, taken.added);
  return taken;
}

void VotedMap::erase(TileKey key) {
  for (voting::VotingField& field : fields_) field.remove(key);
  points_.erase(key);
}

void VotedMap::clear() {
  points_.clear();
  for (voting::VotingField& field : fields_) field.clear();
  moves_.clear();
  changed_.clear();
}

void VotedMap::reassign(const std::function<bool(TileKey)>& matters, double x, double y) {
  moves_.clear();
  for (const auto& [key, tile] : points_.tiles()) {
    const bool in = matters(key);
    if (in ? num_voted(key) < tile.points.size() : num_voted(key) > 0) moves_.push_back({key, in});
  }
  std::stable_sort(moves_.begin(), moves_.end(), [&](const Move& a, const Move& b) {
    return a.in != b.in ? a.in : squared_distance(a.key, x, y) < squared_distance(b.key, x, y);
  });
}

std::size_t VotedMap::bring_in(TileKey key) {
  const PointTile* const tile = points_.find(key);
  if (tile == nullptr) return 0;  // released in the meantime
  const auto missing = std::span(tile->points).subspan(num_voted(key));
  for (voting::VotingField& field : fields_) field.add(key, tile->z_origin * kStepsPerMetre, missing);
  // The last tile to be added makes its neighbours current, whether or not its votes reach them.
  for_each_around(key, [&](TileKey around) { changed_.insert(around); });
  return missing.size();
}

std::size_t VotedMap::take_out(TileKey key) {
  const std::size_t count = num_voted(key);
  for (voting::VotingField& field : fields_) field.remove(key);
  return count;
}

void VotedMap::move(std::size_t num_points) {
  std::size_t moved = 0;
  while (!moves_.empty() && moved < num_points) {
    const Move next = moves_.front();
    moves_.pop_front();
    moved += next.in ? bring_in(next.key) : take_out(next.key);
  }
}

void VotedMap::set_time(std::int64_t now) {
  for (voting::VotingField& field : fields_) field.set_time(now);
}

bool VotedMap::is_current(TileKey key) const {
  bool current = true;
  for_each_around(key, [&](TileKey around) {
    const PointTile* const tile = points_.find(around);
    current = current && (tile == nullptr || num_voted(around) == tile->points.size());
  });
  return current;
}

bool VotedMap::is_asleep(TileKey key) const {
  return std::all_of(fields_.begin(), fields_.end(),
                     [&](const voting::VotingField& field) { return field.is_asleep(key); });
}

std::int32_t VotedMap::revision(TileKey key) const {
  const PointTile* const tile = points_.find(key);
  if (tile == nullptr) return 0;
  auto total = static_cast<std::int64_t>(tile->points.size());
  for (const voting::VotingField& field : fields_) total += field.num_votes(key);
  for (int i = 0; i < 9; ++i) {  // removed points take votes with them: the revision must grow nevertheless
    const PointTile* const around = points_.find({key.x + i % 3 - 1, key.y + i / 3 - 1});
    if (around != nullptr) total += votes_of_a_point_ * around->removals[static_cast<std::size_t>(8 - i)];
  }
  return static_cast<std::int32_t>(std::min<std::int64_t>(total, std::numeric_limits<std::int32_t>::max()));
}

std::vector<TileKey> VotedMap::take_changed() {
  for (voting::VotingField& field : fields_) {
    for (const TileKey& key : field.take_changed()) changed_.insert(key);
  }
  std::vector<TileKey> keys(changed_.begin(), changed_.end());
  changed_.clear();
  return keys;
}

std::int64_t VotedMap::num_pairs() const {
  std::int64_t pairs = 0;
  for (const voting::VotingField& field : fields_) pairs += field.num_pairs();
  return pairs;
}

}  // namespace curbstone::tensor_voting::worker
