#include "services/tensor_voting/cuda/cuda_voting_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "services/tensor_voting/cuda/cuda_backend.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "services/tensor_voting/voting/voxel_table.hpp"

namespace curbstone::tensor_voting::cuda {

namespace {

constexpr std::size_t kMaxVoters = std::size_t{1} << 31;

std::string name_of(TileKey key) {
  return "tile (" + std::to_string(key.x) + ", " + std::to_string(key.y) + ")";
}

/// Wraps for tiles thousands of kilometres away: only differences are used.
std::int32_t in_map(std::int32_t tile, int step) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(tile) * kStepsPerTile + static_cast<std::uint32_t>(step));
}

/// The position of a point in the field, in steps from the corner of the field's origin.
std::array<std::int64_t, 3> place_of(TileKey origin, TileKey key, std::int32_t z_origin, const TilePoint& point) {
  return {(std::int64_t{key.x} - origin.x) * kStepsPerTile + point.x,
          (std::int64_t{key.y} - origin.y) * kStepsPerTile + point.y, std::int64_t{z_origin} + point.z};
}

}  // namespace

struct CudaVotingField::Tile {
  std::uint32_t slot = 0;
  std::int32_t z_origin = 0;
  std::vector<std::uint32_t> voter_of_point;
  std::uint32_t num_voters = 0;
  voting::VoxelTable voxels;
};

/// New voters to be uploaded to the device.
struct CudaVotingField::Fresh {
  std::vector<std::uint64_t> keys;
  std::vector<ResidentVoter> voters;
};

CudaVotingField::CudaVotingField(const voting::VotingParameters& parameters, std::size_t max_voters)
    : CudaVotingField(parameters, max_voters, make_resident_voters) {}

CudaVotingField::CudaVotingField(const voting::VotingParameters& parameters, std::size_t max_voters,
                                 const MakeVoters& make_voters)
    : max_voters_(std::min(max_voters, kMaxVoters)) {
  (void)voting::VotingField(parameters);  // throws on invalid parameters
  voxel_ = static_cast<int>(std::lround(parameters.voxel / kPositionStep));
  grid_ = std::make_unique<CellGrid>(CellGrid::for_radius(parameters.radius / kPositionStep, 1, 1));
  voters_ = make_voters(*grid_, kernels::decay_in_steps(parameters.sigma, parameters.radius, kPositionStep));
}

CudaVotingField::~CudaVotingField() = default;
CudaVotingField::CudaVotingField(CudaVotingField&&) noexcept = default;
CudaVotingField& CudaVotingField::operator=(CudaVotingField&&) noexcept = default;

template <class Work>
auto CudaVotingField::guarded(const Work& work) {
  try {
    return work();
  } catch (...) {
    clear();
    throw;
  }
}

void CudaVotingField::check(std::span<const Addition> additions, TileKey origin) const {
  std::size_t num_points = 0;
  for (const Addition& addition : additions) {
    const auto tile = tiles_.find(addition.key);
    const std::int32_t z_origin = tile == tiles_.end() ? addition.z_origin : tile->second->z_origin;
    for (const TilePoint& p : addition.points) {
      if (p.x < 0 || p.x >= kStepsPerTile || p.y < 0 || p.y >= kStepsPerTile) {
        throw std::invalid_argument(name_of(addition.key) + ": a point lies outside of it");
      }
      const auto [x, y, z] = place_of(origin, addition.key, z_origin, p);
      if (!grid_->contains(x, y, z)) {
        throw std::invalid_argument(name_of(addition.key) + ": too far from " + name_of(origin) +
                                    ", where the field began");
      }
    }
    num_points += addition.points.size();
  }
  if (num_points > max_voters_ - num_voters_) {
    throw std::runtime_error("the field is full: " + std::to_string(num_voters_) + " voters and " +
                             std::to_string(num_points) + " points, at most " + std::to_string(max_voters_));
  }
}

std::uint32_t CudaVotingField::take_slot(TileKey key) {
  if (free_slots_.empty()) {
    key_of_slot_.push_back(key);
    return static_cast<std::uint32_t>(key_of_slot_.size() - 1);
  }
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  key_of_slot_[slot] = key;
  return slot;
}

void CudaVotingField::append(const Addition& addition, Fresh& fresh) {
  std::unique_ptr<Tile>& tile = tiles_[addition.key];
  if (!tile) {
    tile = std::make_unique<Tile>();
    tile->slot = take_slot(addition.key);
    tile->z_origin = addition.z_origin;
  }
  changed_.insert(addition.key);
  for (const TilePoint& p : addition.points) {
    const auto [x, y, z] = place_of(origin_, addition.key, tile->z_origin, p);
    std::uint32_t voter = tile->num_voters;
    if (voxel_ > 0) {
      voter = tile->voxels.find_or_insert(
          voting::VoxelTable::key(p.x / voxel_, p.y / voxel_, CellGrid::floor_div(z, voxel_)));
    }
    tile->voter_of_point.push_back(voter);
    if (voter != tile->num_voters) continue;
    const kernels::StepPoint at{in_map(addition.key.x, p.x), in_map(addition.key.y, p.y), static_cast<std::int32_t>(z)};
    fresh.keys.push_back(grid_->key(x, y, z));
    fresh.voters.push_back({at, tile->slot, tile->num_voters++});
  }
}

void CudaVotingField::add(std::span<const Addition> additions) {
  const auto first = std::find_if(additions.begin(), additions.end(), [](const auto& a) { return !a.points.empty(); });
  if (first == additions.end()) return;
  const TileKey origin = tiles_.empty() ? first->key : origin_;
  check(additions, origin);
  origin_ = origin;
  guarded([&] {
    Fresh fresh;
    for (const Addition& addition : additions) {
      if (!addition.points.empty()) append(addition, fresh);
    }
    if (fresh.keys.empty()) return;
    note_changes(voters_->add(fresh.keys, fresh.voters, static_cast<std::uint32_t>(key_of_slot_.size())));
    num_voters_ += fresh.keys.size();
  });
}

void CudaVotingField::add(TileKey key, std::int32_t z_origin, std::span<const TilePoint> points) {
  const Addition addition{key, z_origin, points};
  add(std::span(&addition, 1));
}

void CudaVotingField::remove(std::span<const TileKey> keys) {
  guarded([&] {
    std::vector<std::uint8_t> slots(key_of_slot_.size(), 0);
    std::uint32_t count = 0;
    for (const TileKey& key : keys) {
      const auto it = tiles_.find(key);
      if (it == tiles_.end()) continue;
      slots[it->second->slot] = 1;
      free_slots_.push_back(it->second->slot);
      count += it->second->num_voters;
      changed_.insert(key);
      tiles_.erase(it);
    }
    if (count == 0) return;
    note_changes(voters_->remove(slots, count));
    num_voters_ -= count;
  });
}

void CudaVotingField::remove(TileKey key) {
  remove(std::span(&key, 1));
}

void CudaVotingField::clear() {
  voters_->clear();
  tiles_.clear();
  key_of_slot_.clear();
  free_slots_.clear();
  changed_.clear();
  num_voters_ = 0;
}

void CudaVotingField::note_changes(const std::vector<std::uint8_t>& changed) {
  for (std::size_t slot = 0; slot < changed.size(); ++slot) {
    if (changed[slot] != 0) changed_.insert(key_of_slot_[slot]);
  }
}

std::size_t CudaVotingField::num_points(TileKey key) const {
  return voters_of_points(key).size();
}

std::size_t CudaVotingField::num_voters(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? 0 : it->second->num_voters;
}

std::span<const std::uint32_t> CudaVotingField::voters_of_points(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? std::span<const std::uint32_t>() : it->second->voter_of_point;
}

std::vector<TileKey> CudaVotingField::take_changed() {
  std::vector<TileKey> keys(changed_.begin(), changed_.end());
  changed_.clear();
  return keys;
}

std::vector<CudaVotingField::TileVotes> CudaVotingField::votes(std::span<const TileKey> keys) {
  std::vector<std::uint32_t> offsets(key_of_slot_.size(), ResidentVoters::kUnwanted);
  std::uint32_t total = 0;
  for (const TileKey& key : keys) {
    const auto it = tiles_.find(key);
    if (it == tiles_.end() || offsets[it->second->slot] != ResidentVoters::kUnwanted) continue;
    offsets[it->second->slot] = total;
    total += it->second->num_voters;
  }
  std::vector<TileVotes> result(keys.size());
  if (total == 0) return result;
  const std::vector<ResidentSums> sums = guarded([&] { return voters_->sums(offsets, total); });
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto it = tiles_.find(keys[i]);
    if (it == tiles_.end()) continue;
    const auto of_tile = std::span(sums).subspan(offsets[it->second->slot], it->second->num_voters);
    for (const ResidentSums& from : of_tile) {
      std::copy(std::begin(from.value), std::end(from.value), result[i].sums.emplace_back().value.begin());
      result[i].num_votes += from.votes;
    }
  }
  return result;
}

CudaVotingField::TileVotes CudaVotingField::votes(TileKey key) {
  return std::move(votes(std::span(&key, 1))[0]);
}

}  // namespace curbstone::tensor_voting::cuda
