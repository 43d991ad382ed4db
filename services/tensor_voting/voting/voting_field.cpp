#include "services/tensor_voting/voting/voting_field.hpp"

#include <algorithm>
#include <array>

#include "services/tensor_voting/voting/voter_tile.hpp"

namespace curbstone::tensor_voting::voting {

/// A point that is the first one in its voxel.
struct VotingField::NewVoter {
  std::uint32_t index;
  FieldCell cell;
  FieldPlace place;

  bool operator<(const NewVoter& other) const { return cell != other.cell ? cell < other.cell : index < other.index; }
};

/// A tile and its eight neighbours, where they exist.
struct VotingField::Neighbourhood {
  static constexpr std::uint32_t kCentre = 4;
  TileKey centre;
  std::array<VoterTile*, 9> tiles{};
  std::array<bool, 9> changed{};

  [[nodiscard]] TileKey key(int i) const { return {centre.x + i % 3 - 1, centre.y + i / 3 - 1}; }
};

VotingField::VotingField(const VotingParameters& parameters)
    : parameters_(parameters),
      grid_(parameters),
      kernel_(kernels::vote_kernels()[0]),
      decay_(kernels::decay_in_steps(parameters.sigma, parameters.radius, kPositionStep)) {}

VotingField::~VotingField() = default;
VotingField::VotingField(VotingField&&) noexcept = default;
VotingField& VotingField::operator=(VotingField&&) noexcept = default;

/// The tile and its neighbours, all of them awake.
VotingField::Neighbourhood VotingField::around(TileKey key) const {
  Neighbourhood result{.centre = key};
  for (int i = 0; i < 9; ++i) {
    VoterTile* const tile = find(result.key(i));
    if (tile != nullptr) wake(result.key(i), *tile);
    result.tiles[static_cast<std::size_t>(i)] = tile;
  }
  return result;
}

void VotingField::wake(TileKey key, VoterTile& tile) const {
  tile.wake([&](const kernels::StepPoint& at) {
    return grid_.thins() ? grid_.voxel_of(FieldPlace(key, at)) : std::uint64_t{0};
  });
  uses_.used(key, now_);
}

/// Puts at most one tile to sleep, so that there is no pause when a drive leaves many tiles behind.
void VotingField::sleep_unused() {
  const auto key = uses_.take_unused(kAwake, now_);
  if (key) find(*key)->sleep();
}

VoterTile* VotingField::find(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : it->second.get();
}

void VotingField::find_near(const Neighbourhood& around, const FieldCell& cell, bool with_own_tile) {
  const int n = grid_.cells_per_tile();
  const int reach = grid_.reach();
  const std::int64_t reach2 = grid_.radius() * grid_.radius();
  const auto gap2 = [&](int d) { return grid_.gap(d) * grid_.gap(d); };
  near_.clear();
  near_places_.clear();
  for (int y = cell.y - reach; y <= cell.y + reach; ++y) {
    for (int x = cell.x - reach; x <= cell.x + reach; ++x) {
      const std::int64_t away2 = gap2(x - cell.x) + gap2(y - cell.y);
      if (away2 >= reach2) continue;
      const int right = x < 0 ? -1 : x >= n ? 1 : 0;  // tiles; a vote reaches at most the next one
      const int up = y < 0 ? -1 : y >= n ? 1 : 0;
      const auto t = static_cast<std::size_t>(3 * (1 + up) + 1 + right);
      VoterTile* const tile = around.tiles[t];
      if (tile == nullptr || (t == Neighbourhood::kCentre && !with_own_tile)) continue;
      for (std::int32_t i = tile->columns[grid_.column_of(x - n * right, y - n * up)]; i >= 0;) {
        const VoterTile::Link& link = tile->links[static_cast<std::size_t>(i)];
        VoterTile::Block& block = tile->block(static_cast<std::size_t>(i));
        const auto number = static_cast<std::uint32_t>(i);
        i = link.next;
        if (away2 + gap2(link.layer - cell.z) >= reach2) continue;
        for (const auto* line : {&block.voters.x, &block.voters.z}) __builtin_prefetch(line);
        near_.push_back({&block.voters, &block.settled, 0});
        near_places_.push_back({static_cast<std::uint32_t>(t), number});
      }
    }
  }
}

std::int64_t VotingField::exchange(const kernels::StepPoint& at, float sign, kernels::VoteSums& sums) {
  const std::int64_t pairs = kernel_.exchange(decay_, at, sign, near_.data(), near_.size(), sums.value.data());
  num_pairs_ += pairs;
  return pairs;
}

void VotingField::apply_votes(Neighbourhood& around, std::int64_t sign) {
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (near_[i].pairs == 0) continue;
    VoterTile& tile = *around.tiles[near_places_[i].tile];
    tile.num_votes += sign * near_[i].pairs;
    tile.changed[near_places_[i].block] = change_;
    around.changed[near_places_[i].tile] = true;
  }
}

std::vector<VotingField::NewVoter> VotingField::admit(TileKey key, VoterTile& tile,
                                                      std::span<const TilePoint> points) const {
  std::vector<NewVoter> admitted;
  admitted.reserve(points.size());
  make_room(points.size(), tile.voter_of_point);
  for (const TilePoint& point : points) {
    const FieldPlace place(key, tile.z_origin, point);
    const auto next = static_cast<std::uint32_t>(tile.slots.size());
    const std::uint32_t voter = grid_.thins() ? tile.voxels.find_or_insert(grid_.voxel_of(place)) : next;
    tile.voter_of_point.push_back(voter);
    if (voter != next) continue;
    make_room(1, tile.point_of_voter);
    tile.point_of_voter.push_back(static_cast<std::uint32_t>(tile.voter_of_point.size() - 1));
    make_room(1, tile.slots);
    tile.slots.emplace_back();
    admitted.push_back({voter, grid_.cell_of(place), place});
  }
  return admitted;
}

void VotingField::add(TileKey key, std::int32_t z_origin, std::span<const TilePoint> points) {
  if (points.empty()) return;
  ++change_;
  sleep_unused();
  std::unique_ptr<VoterTile>& tile = tiles_[key];
  if (!tile) tile = std::make_unique<VoterTile>(z_origin, grid_.columns_per_tile());
  Neighbourhood around = this->around(key);
  around.changed[Neighbourhood::kCentre] = true;
  // Cell by cell, so that the neighbourhood of a cell is looked up once and stays in the cache. The sums do not depend
  // on this order.
  std::vector<NewVoter> admitted = admit(key, *tile, points);
  std::sort(admitted.begin(), admitted.end());
  for (auto begin = admitted.begin(), end = begin; begin != admitted.end(); begin = end) {
    end = std::find_if(begin, admitted.end(), [&](const NewVoter& voter) { return voter.cell != begin->cell; });
    const std::size_t column = grid_.column_of(begin->cell.x, begin->cell.y);
    find_near(around, begin->cell, true);
    for (auto voter = begin; voter != end; ++voter) {
      kernels::VoteSums sums;
      tile->num_votes += exchange(voter->place.in_map, 1.0F, sums);
      const std::uint32_t index = tile->block_for(column, voter->cell.z);
      VoterTile::Block& block = tile->block(index);
      const std::size_t lane = block.voters.push_back(voter->place.in_map);
      tile->changed[index] = change_;
      tile->voters[index][lane] = voter->index;
      kernels::set_sums(sums, block.voters, block.settled, lane);
      tile->slots[voter->index] = VoterTile::VoterSlot::at(index, lane);
      if (lane == 0) {
        near_.push_back({&block.voters, &block.settled, 0});
        near_places_.push_back({Neighbourhood::kCentre, index});
      }
    }
    apply_votes(around, 1);
  }
  note_changes(around);
}

void VotingField::remove(TileKey key) {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return;
  ++change_;
  const VoterTile& tile = *it->second;
  Neighbourhood around = this->around(key);
  for (std::size_t i = 0; i < tile.links.size(); ++i) {
    const kernels::VoterBlock& block = tile.block(i).voters;
    find_near(around, grid_.cell_of(FieldPlace(key, block.at(0))), false);
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(block.num_voters); ++lane) {
      kernels::VoteSums unused;
      exchange(block.at(lane), -1.0F, unused);
    }
    apply_votes(around, -1);
  }
  around.changed[Neighbourhood::kCentre] = true;
  note_changes(around);
  uses_.erase(key);
  tiles_.erase(it);
}

void VotingField::note_changes(const Neighbourhood& around) {
  for (int i = 0; i < 9; ++i) {
    if (around.changed[static_cast<std::size_t>(i)]) changed_.insert(around.key(i));
  }
}

void VotingField::clear() {
  tiles_.clear();
  uses_.clear();
  changed_.clear();
}

bool VotingField::is_asleep(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile != nullptr && tile->asleep;
}

std::size_t VotingField::num_points(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile == nullptr ? 0 : tile->voter_of_point.size();
}

std::size_t VotingField::num_voters(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile == nullptr ? 0 : tile->slots.size();
}

std::int64_t VotingField::num_votes(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile == nullptr ? 0 : tile->num_votes;
}

std::span<const std::uint32_t> VotingField::voters_of_points(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile == nullptr ? std::span<const std::uint32_t>() : tile->voter_of_point;
}

std::span<const std::uint32_t> VotingField::points_of_voters(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile == nullptr ? std::span<const std::uint32_t>() : tile->point_of_voter;
}

std::vector<kernels::VoteSums> VotingField::sums(TileKey key) const {
  const VoterTile* const tile = find(key);
  return tile == nullptr ? std::vector<kernels::VoteSums>() : tile->sums();
}

void VotingField::for_each_changed(TileKey key, std::int64_t since,
                                   const std::function<void(const ReceivedBlock&)>& visit) const {
  VoterTile* const tile = find(key);
  if (tile == nullptr) return;
  wake(key, *tile);
  ReceivedBlock received;
  for (std::uint32_t i = 0; i < tile->changed.size(); ++i) {
    if (tile->changed[i] <= since) continue;
    const VoterTile::Block& block = tile->block(i);
    received.number = i;
    received.voters = std::span(tile->voters[i]).first(static_cast<std::size_t>(block.voters.num_voters));
    for (std::size_t c = 0; c < received.sums.size(); ++c) {
      for (std::size_t lane = 0; lane < kernels::kLanes; ++lane) {
        received.sums[c][lane] = kernels::sum_of(block.settled.value[c][lane], block.voters.recent[c][lane]);
      }
    }
    visit(received);
  }
}

std::vector<TileKey> VotingField::take_changed() {
  std::vector<TileKey> keys(changed_.begin(), changed_.end());
  changed_.clear();
  return keys;
}

}  // namespace curbstone::tensor_voting::voting
