#include "services/tensor_voting/voting_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "services/tensor_voting/voxel_table.hpp"

namespace curbstone {

namespace {

int floor_div(int a, int b) {
  return a / b - (a % b != 0 && (a < 0) != (b < 0));
}

/// The smallest edge (in steps) of cells that tile a tile and span `radius` with `reach` cells.
int smallest_cell(int radius, int reach) {
  for (int n = kStepsPerTile; n > 1; --n) {
    if (kStepsPerTile % n == 0 && reach * (kStepsPerTile / n) >= radius) return kStepsPerTile / n;
  }
  return kStepsPerTile;
}

/// Distance from `v` to the interval [low, low + size).
int distance_to(int v, int low, int size) {
  return v < low ? low - v : v >= low + size ? v - (low + size - 1) : 0;
}

}  // namespace

/// The voters of a cube of space, kLanes to a block. The cells of one column of a tile are chained.
struct VotingField::Cell {
  int z = 0;  // index: floor(z / edge)
  int next = -1;
  std::uint32_t size = 0;
  std::vector<VoterBlock> blocks;

  void push_back(const StepPoint& at, const VoteSums& sums) {
    const std::size_t lane = size % kLanes;
    if (lane == 0) {
      VoterBlock& block = blocks.emplace_back();
      block.x.fill(nowhere_near(at.x));
      block.y.fill(at.y);
      block.z.fill(at.z);
    }
    VoterBlock& block = blocks.back();
    block.x[lane] = at.x;
    block.y[lane] = at.y;
    block.z[lane] = at.z;
    for (std::size_t c = 0; c < VoteSums::kCount; ++c) block.sums[c][lane] = sums.value[c];
    ++size;
  }
};

struct VotingField::Voter {
  std::uint32_t cell;
  std::uint32_t slot;
};

struct VotingField::Tile {
  std::int32_t z_origin = 0;
  std::vector<std::uint32_t> voter_of_point;
  std::vector<Voter> voters;
  std::vector<Cell> cells;
  std::vector<int> columns;  // first cell of each, or -1
  VoxelTable voxels;
  std::int64_t num_votes = 0;

  /// The cell at height index z of a column; made if there is none.
  std::uint32_t cell_at(std::size_t column, int z) {
    for (int c = columns[column]; c >= 0; c = cells[static_cast<std::size_t>(c)].next) {
      if (cells[static_cast<std::size_t>(c)].z == z) return static_cast<std::uint32_t>(c);
    }
    Cell& cell = cells.emplace_back();
    cell.z = z;
    cell.next = columns[column];
    columns[column] = static_cast<int>(cells.size() - 1);
    return static_cast<std::uint32_t>(cells.size() - 1);
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
  // Small cells waste fewer tests on pairs out of reach, unless they are so small that blocks stay half empty.
  cell_ = smallest_cell(radius_, 2);
  if (cell_ < 5 * voxel_) cell_ = smallest_cell(radius_, 1);
  cells_per_tile_ = kStepsPerTile / cell_;
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

std::int64_t VotingField::exchange(Neighbourhood& around, const Place& place, float sign, bool with_own_tile,
                                   VoteSums& sums) {
  const int n = cells_per_tile_;
  const std::int64_t reach2 = std::int64_t{radius_} * radius_;
  const auto square = [](std::int64_t v) { return v * v; };
  const int column_x = place.x / cell_;
  const int column_y = place.y / cell_;
  ranges_.clear();
  range_tiles_.clear();
  for (int iy = column_y - reach_; iy <= column_y + reach_; ++iy) {
    for (int ix = column_x - reach_; ix <= column_x + reach_; ++ix) {
      const std::int64_t away2 =
          square(distance_to(place.x, ix * cell_, cell_)) + square(distance_to(place.y, iy * cell_, cell_));
      if (away2 >= reach2) continue;
      const auto t = static_cast<std::size_t>(3 * (1 + floor_div(iy, n)) + 1 + floor_div(ix, n));
      Tile* const tile = around.tiles[t];
      if (tile == nullptr || (t == Neighbourhood::kCentre && !with_own_tile)) continue;
      const int column = (iy - n * floor_div(iy, n)) * n + (ix - n * floor_div(ix, n));
      for (int c = tile->columns[static_cast<std::size_t>(column)]; c >= 0;) {
        Cell& cell = tile->cells[static_cast<std::size_t>(c)];
        c = cell.next;
        if (away2 + square(distance_to(place.z, cell.z * cell_, cell_)) >= reach2) continue;
        ranges_.push_back({cell.blocks.data(), cell.blocks.size(), 0});
        range_tiles_.push_back(t);
      }
    }
  }
  kernel_.exchange(decay_, place.in_map, sign, ranges_.data(), ranges_.size(), sums.value.data());
  std::int64_t total = 0;
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    if (ranges_[i].pairs == 0) continue;
    around.tiles[range_tiles_[i]]->num_votes += sign > 0 ? ranges_[i].pairs : -ranges_[i].pairs;
    around.changed[range_tiles_[i]] = true;
    total += ranges_[i].pairs;
  }
  return total;
}

std::uint64_t VotingField::voxel_of(const Place& place) const {
  return VoxelTable::key(place.x / voxel_, place.y / voxel_, floor_div(place.z, voxel_));
}

void VotingField::add(TileKey key, std::int32_t z_origin, std::span<const TilePoint> points) {
  if (points.empty()) return;
  std::unique_ptr<Tile>& tile = tiles_[key];
  if (!tile) {
    tile = std::make_unique<Tile>();
    tile->z_origin = z_origin;
    tile->columns.assign(static_cast<std::size_t>(cells_per_tile_) * static_cast<std::size_t>(cells_per_tile_), -1);
  }
  Neighbourhood around = this->around(key);
  around.changed[Neighbourhood::kCentre] = true;
  for (const TilePoint& point : points) {
    const Place place(key, tile->z_origin, point);
    const auto next = static_cast<std::uint32_t>(tile->voters.size());
    const std::uint32_t voter = voxel_ > 0 ? tile->voxels.find_or_insert(voxel_of(place), next) : next;
    tile->voter_of_point.push_back(voter);
    if (voter != next) continue;

    VoteSums sums;
    const std::int64_t pairs = exchange(around, place, 1.0F, true, sums);
    tile->num_votes += pairs;
    num_pairs_ += pairs;
    const auto column = static_cast<std::size_t>(place.y / cell_ * cells_per_tile_ + place.x / cell_);
    const std::uint32_t cell = tile->cell_at(column, floor_div(place.z, cell_));
    tile->voters.push_back({cell, tile->cells[cell].size});
    tile->cells[cell].push_back(place.in_map, sums);
  }
  note_changes(around);
}

void VotingField::remove(TileKey key) {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return;
  const Tile& tile = *it->second;
  Neighbourhood around = this->around(key);
  for (const Voter& voter : tile.voters) {
    VoteSums unused;
    num_pairs_ += exchange(around, place_of(key, tile, voter), -1.0F, false, unused);
  }
  around.changed[Neighbourhood::kCentre] = true;
  note_changes(around);
  tiles_.erase(it);
}

VotingField::Place VotingField::place_of(TileKey key, const Tile& tile, const Voter& voter) {
  const VoterBlock& block = tile.cells[voter.cell].blocks[voter.slot / kLanes];
  const std::size_t lane = voter.slot % kLanes;
  return {key, StepPoint{block.x[lane], block.y[lane], block.z[lane]}};
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

std::vector<VoteSums> VotingField::sums(TileKey key) const {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return {};
  std::vector<VoteSums> result;
  result.reserve(it->second->voters.size());
  for (const Voter& voter : it->second->voters) {
    const VoterBlock& block = it->second->cells[voter.cell].blocks[voter.slot / kLanes];
    result.push_back(block.sums_of(voter.slot % kLanes));
  }
  return result;
}

std::vector<TileKey> VotingField::take_changed() {
  std::vector<TileKey> keys(changed_.begin(), changed_.end());
  changed_.clear();
  return keys;
}

}  // namespace curbstone
