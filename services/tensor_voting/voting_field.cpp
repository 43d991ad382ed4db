#include "services/tensor_voting/voting_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "services/tensor_voting/voxel_table.hpp"

namespace curbstone {

namespace {

/// The smallest edge (in steps) of cells that tile a tile and span `radius` with `reach` cells.
int smallest_cell(int radius, int reach) {
  for (int n = kStepsPerTile; n > 1; --n) {
    if (kStepsPerTile % n == 0 && reach * (kStepsPerTile / n) >= radius) return kStepsPerTile / n;
  }
  return kStepsPerTile;
}

}  // namespace

/// Of a cell within its tile; z counts from the map's zero.
struct VotingField::CellIndex {
  int x;
  int y;
  int z;
  auto operator<=>(const CellIndex&) const = default;
};

/// Where a voter of a tile stands.
struct VotingField::Voter {
  std::uint32_t block;
  std::uint32_t lane;
};

/// The voters of a tile in blocks; a block's are of one cell. The blocks of one column of cells are chained, apart from
/// the blocks themselves: a walk along a chain must not wait for each of them to come from memory.
struct VotingField::Tile {
  struct Block {
    VoterBlock voters;
    SettledSums settled;
  };
  struct Link {
    int layer;  // height index of the cell
    std::int32_t next;
  };
  static constexpr std::size_t kBlocksPerChunk = 8;
  using Chunk = std::array<Block, kBlocksPerChunk>;

  std::int32_t z_origin = 0;
  std::vector<std::uint32_t> voter_of_point;
  std::vector<Voter> voters;
  std::vector<std::uint32_t> point_of_voter;
  std::vector<std::int32_t> columns;           // first block of each, or -1
  std::vector<Link> links;                     // of each block
  std::vector<std::unique_ptr<Chunk>> chunks;  // blocks stay where they are
  VoxelTable voxels;
  std::int64_t num_votes = 0;

  [[nodiscard]] Block& block(std::size_t i) const { return (*chunks[i / kBlocksPerChunk])[i % kBlocksPerChunk]; }

  /// A block with a lane left for the cell at height index `z` of a column; made if there is none.
  std::uint32_t block_for(std::size_t column, int z) {
    for (std::int32_t i = columns[column]; i >= 0; i = links[static_cast<std::size_t>(i)].next) {
      const auto index = static_cast<std::size_t>(i);
      if (links[index].layer == z && block(index).voters.num_voters < kLanes) return static_cast<std::uint32_t>(i);
    }
    const std::size_t made = links.size();
    if (made % kBlocksPerChunk == 0) chunks.push_back(std::make_unique<Chunk>());
    links.push_back({z, columns[column]});
    columns[column] = static_cast<std::int32_t>(made);
    return static_cast<std::uint32_t>(made);
  }
};

/// A point of a tile. Cells are found by coordinates within the tile, pairs by coordinates in the map.
struct VotingField::Place {
  int x;  // steps from the tile's corner
  int y;
  int z;  // steps, in map
  StepPoint in_map;

  Place(TileKey key, std::int32_t z_origin, const TilePoint& point)
      : x(point.x), y(point.y), z(z_origin + point.z), in_map{plus(corner(key.x), x), plus(corner(key.y), y), z} {}
  Place(TileKey key, const StepPoint& at)
      : x(plus(at.x, corner(-key.x))), y(plus(at.y, corner(-key.y))), z(at.z), in_map(at) {}

  /// Wraps for tiles thousands of kilometres away: only differences count.
  static std::int32_t corner(std::int32_t tile) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(tile) * kStepsPerTile);
  }
  static std::int32_t plus(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  }
};

/// A point that is the first in its voxel.
struct VotingField::NewVoter {
  std::uint32_t index;
  CellIndex cell;
  Place place;

  bool operator<(const NewVoter& other) const { return cell != other.cell ? cell < other.cell : index < other.index; }
};

/// A tile and the eight around it, where they exist.
struct VotingField::Neighbourhood {
  static constexpr std::size_t kCentre = 4;
  TileKey centre;
  std::array<Tile*, 9> tiles{};
  std::array<bool, 9> changed{};

  [[nodiscard]] TileKey key(int i) const { return {centre.x + i % 3 - 1, centre.y + i / 3 - 1}; }
};

VotingField::VotingField(const VotingParameters& parameters) : parameters_(parameters), kernel_(vote_kernels()[0]) {
  validate(parameters);
  if (parameters.radius > kTileSize) throw std::invalid_argument("radius: expected at most a tile (3 m)");
  voxel_ = static_cast<int>(std::lround(parameters.voxel / kPositionStep));
  if (std::abs(voxel_ * kPositionStep - parameters.voxel) > 1e-9 || (voxel_ > 0 && kStepsPerTile % voxel_ != 0)) {
    throw std::invalid_argument("voxel = " + std::to_string(parameters.voxel) +
                                ": expected a multiple of 0.002 m that divides 3 m");
  }
  decay_ = decay_in_steps(parameters.sigma, parameters.radius, kPositionStep);
  radius_ = static_cast<int>(std::ceil(parameters.radius / kPositionStep - 1e-9));
  // Small cells waste fewer tests on pairs out of reach. But thinned voters are few: small cells would leave their
  // blocks half empty, and memory that is touched for little is what costs most here.
  cell_ = smallest_cell(radius_, voxel_ > 0 ? 1 : 2);
  cells_per_tile_ = kStepsPerTile / cell_;
  by_cell_ = Divisor(cell_);
  if (voxel_ > 0) by_voxel_ = Divisor(voxel_);
  reach_ = (radius_ + cell_ - 1) / cell_;
}

VotingField::~VotingField() = default;
VotingField::VotingField(VotingField&&) noexcept = default;
VotingField& VotingField::operator=(VotingField&&) noexcept = default;

VotingField::Neighbourhood VotingField::around(TileKey key) const {
  Neighbourhood result{.centre = key};
  for (int i = 0; i < 9; ++i) {
    const auto it = tiles_.find(result.key(i));
    result.tiles[static_cast<std::size_t>(i)] = it == tiles_.end() ? nullptr : it->second.get();
  }
  return result;
}

VotingField::CellIndex VotingField::cell_of(const Place& place) const {
  return {by_cell_.floor(place.x), by_cell_.floor(place.y), by_cell_.floor(place.z)};
}

std::size_t VotingField::column_of(const CellIndex& cell) const {
  return static_cast<std::size_t>(cell.y * cells_per_tile_ + cell.x);
}

void VotingField::find_near(const Neighbourhood& around, const CellIndex& cell, bool with_own_tile) {
  const int n = cells_per_tile_;
  const std::int64_t reach2 = std::int64_t{radius_} * radius_;
  const auto square = [](std::int64_t v) { return v * v; };
  // Between the sides of two cells that lie `d` cells apart.
  const auto gap = [&](int d) { return std::max(0, std::abs(d) - 1) * cell_; };
  near_.clear();
  near_tiles_.clear();
  for (int y = cell.y - reach_; y <= cell.y + reach_; ++y) {
    for (int x = cell.x - reach_; x <= cell.x + reach_; ++x) {
      const std::int64_t away2 = square(gap(x - cell.x)) + square(gap(y - cell.y));
      if (away2 >= reach2) continue;
      const int right = x < 0 ? -1 : x >= n ? 1 : 0;  // tiles; nothing reaches farther than the next one
      const int up = y < 0 ? -1 : y >= n ? 1 : 0;
      const auto t = static_cast<std::size_t>(3 * (1 + up) + 1 + right);
      Tile* const tile = around.tiles[t];
      if (tile == nullptr || (t == Neighbourhood::kCentre && !with_own_tile)) continue;
      const std::size_t column = column_of({x - n * right, y - n * up, 0});
      for (std::int32_t i = tile->columns[column]; i >= 0;) {
        const Tile::Link& link = tile->links[static_cast<std::size_t>(i)];
        Tile::Block& block = tile->block(static_cast<std::size_t>(i));
        i = link.next;
        if (away2 + square(gap(link.layer - cell.z)) >= reach2) continue;
        near_.push_back({&block.voters, &block.settled, 0});
        near_tiles_.push_back(t);
      }
    }
  }
}

std::int64_t VotingField::exchange(const StepPoint& at, float sign, VoteSums& sums) {
  const std::int64_t pairs = kernel_.exchange(decay_, at, sign, near_.data(), near_.size(), sums.value.data());
  num_pairs_ += pairs;
  return pairs;
}

void VotingField::book(Neighbourhood& around, std::int64_t sign) {
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (near_[i].pairs == 0) continue;
    around.tiles[near_tiles_[i]]->num_votes += sign * near_[i].pairs;
    around.changed[near_tiles_[i]] = true;
    near_[i].block->changed = change_;
  }
}

std::uint64_t VotingField::voxel_of(const Place& place) const {
  return VoxelTable::key(by_voxel_.floor(place.x), by_voxel_.floor(place.y), by_voxel_.floor(place.z));
}

std::vector<VotingField::NewVoter> VotingField::admit(TileKey key, Tile& tile,
                                                      std::span<const TilePoint> points) const {
  std::vector<NewVoter> admitted;
  admitted.reserve(points.size());
  for (const TilePoint& point : points) {
    const Place place(key, tile.z_origin, point);
    const auto next = static_cast<std::uint32_t>(tile.voters.size());
    const std::uint32_t voter = voxel_ > 0 ? tile.voxels.find_or_insert(voxel_of(place), next) : next;
    tile.voter_of_point.push_back(voter);
    if (voter != next) continue;
    tile.point_of_voter.push_back(static_cast<std::uint32_t>(tile.voter_of_point.size() - 1));
    tile.voters.emplace_back();
    admitted.push_back({voter, cell_of(place), place});
  }
  return admitted;
}

void VotingField::add(TileKey key, std::int32_t z_origin, std::span<const TilePoint> points) {
  if (points.empty()) return;
  ++change_;
  std::unique_ptr<Tile>& tile = tiles_[key];
  if (!tile) {
    tile = std::make_unique<Tile>();
    tile->z_origin = z_origin;
    tile->columns.assign(static_cast<std::size_t>(cells_per_tile_) * static_cast<std::size_t>(cells_per_tile_), -1);
  }
  Neighbourhood around = this->around(key);
  around.changed[Neighbourhood::kCentre] = true;
  // Cell by cell, so that a cell's surroundings are looked up once and stay in the cache. The sums do not mind the
  // order.
  std::vector<NewVoter> admitted = admit(key, *tile, points);
  std::sort(admitted.begin(), admitted.end());
  for (auto begin = admitted.begin(), end = begin; begin != admitted.end(); begin = end) {
    end = std::find_if(begin, admitted.end(), [&](const NewVoter& voter) { return voter.cell != begin->cell; });
    const std::size_t column = column_of(begin->cell);
    find_near(around, begin->cell, true);
    for (auto voter = begin; voter != end; ++voter) {
      VoteSums sums;
      tile->num_votes += exchange(voter->place.in_map, 1.0F, sums);
      const std::uint32_t index = tile->block_for(column, voter->cell.z);
      Tile::Block& block = tile->block(index);
      const std::size_t lane = block.voters.push_back(voter->place.in_map);
      block.voters.changed = change_;
      for (std::size_t c = 0; c < VoteSums::kCount; ++c) block.settled.value[c][lane] = sums.value[c];
      tile->voters[voter->index] = {index, static_cast<std::uint32_t>(lane)};
      if (lane == 0) {
        near_.push_back({&block.voters, &block.settled, 0});
        near_tiles_.push_back(Neighbourhood::kCentre);
      }
    }
    book(around, 1);
  }
  note_changes(around);
}

void VotingField::remove(TileKey key) {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return;
  ++change_;
  const Tile& tile = *it->second;
  Neighbourhood around = this->around(key);
  for (std::size_t i = 0; i < tile.links.size(); ++i) {
    const VoterBlock& block = tile.block(i).voters;
    find_near(around, cell_of(Place(key, block.at(0))), false);
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(block.num_voters); ++lane) {
      VoteSums unused;
      exchange(block.at(lane), -1.0F, unused);
    }
    book(around, -1);
  }
  around.changed[Neighbourhood::kCentre] = true;
  note_changes(around);
  tiles_.erase(it);
}

void VotingField::note_changes(const Neighbourhood& around) {
  for (int i = 0; i < 9; ++i) {
    if (around.changed[static_cast<std::size_t>(i)]) changed_.insert(around.key(i));
  }
}

void VotingField::clear() {
  tiles_.clear();
  changed_.clear();
}

std::size_t VotingField::num_points(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? 0 : it->second->voter_of_point.size();
}

std::size_t VotingField::num_voters(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? 0 : it->second->voters.size();
}

std::int64_t VotingField::num_votes(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? 0 : it->second->num_votes;
}

std::span<const std::uint32_t> VotingField::voters_of_points(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? std::span<const std::uint32_t>() : it->second->voter_of_point;
}

std::span<const std::uint32_t> VotingField::points_of_voters(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? std::span<const std::uint32_t>() : it->second->point_of_voter;
}

std::vector<VoteSums> VotingField::sums(TileKey key) const {
  return sums(key, voters_changed(key, 0));
}

std::vector<VoteSums> VotingField::sums(TileKey key, std::span<const std::uint32_t> voters) const {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return {};
  std::vector<VoteSums> result;
  result.reserve(voters.size());
  for (const std::uint32_t i : voters) {
    const Voter& voter = it->second->voters[i];
    const Tile::Block& block = it->second->block(voter.block);
    result.push_back(sums_of(block.voters, block.settled, voter.lane));
  }
  return result;
}

std::vector<std::uint32_t> VotingField::voters_changed(TileKey key, std::int64_t since) const {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return {};
  const Tile& tile = *it->second;
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < tile.voters.size(); ++i) {
    if (tile.block(tile.voters[i].block).voters.changed > since) result.push_back(static_cast<std::uint32_t>(i));
  }
  return result;
}

std::vector<TileKey> VotingField::take_changed() {
  std::vector<TileKey> keys(changed_.begin(), changed_.end());
  changed_.clear();
  return keys;
}

}  // namespace curbstone
