#include "services/localizer/fields/field_tile.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace curbstone::localizer::fields {
namespace {

using semantic_map::tile::Around;
using semantic_map::tile::CellClass;
using semantic_map::tile::MapTile;

constexpr int kPatch = 2;     // cells in each direction that determine the direction of an upright piece: 0.6 m square
constexpr int kMinHits = 2;   // of the dense map: the inside of a vehicle's outline was never seen
constexpr int kMaxHits = 20;  // more hits do not make the position of a tall wall more certain
constexpr float kLineShare = 0.15F;  // minor over major variance of a line, at most
constexpr int kMargin = FieldTile::kReach + kPatch;

/// A cell of the tile or of a neighbouring tile.
class CellAround {
 public:
  CellAround(const Around<MapTile>& tiles, int column, int row) {
    const int dx = step_of(column), dy = step_of(row);
    tile_ = tiles.at(dx, dy);
    index_ = static_cast<std::size_t>((row - dy * kCellsPerTile) * kCellsPerTile + column - dx * kCellsPerTile);
  }
  [[nodiscard]] float ground() const {
    if (tile_ == nullptr || !shows_ground(*tile_, index_)) return std::numeric_limits<float>::quiet_NaN();
    return tile_->z_origin + static_cast<float>(kPositionStep) * static_cast<float>(tile_->height[index_]);
  }
  [[nodiscard]] bool is_curb() const { return tile_ != nullptr && tile_->cell_class[index_] == CellClass::kCurb; }
  [[nodiscard]] int hits() const { return tile_ == nullptr ? 0 : std::min(upright_hits(*tile_, index_), kMaxHits); }

 private:
  static int step_of(int i) { return i < 0 ? -1 : (i >= kCellsPerTile ? 1 : 0); }
  const MapTile* tile_;
  std::size_t index_;
};

constexpr int kWindow = kCellsPerTile + 2 * kMargin;
using HitWindow = std::array<int, std::size_t{kWindow} * kWindow>;

std::size_t place(int column, int row) {
  return static_cast<std::size_t>((row + kMargin) * kWindow + column + kMargin);
}

Upright upright_at(const HitWindow& hits, int column, int row) {
  const auto cell = static_cast<float>(kCellSize);
  float sum = 0;
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  Eigen::Matrix2f square = Eigen::Matrix2f::Zero();
  for (int r = row - kPatch; r <= row + kPatch; ++r) {
    for (int c = column - kPatch; c <= column + kPatch; ++c) {
      const auto weight = static_cast<float>(hits[place(c, r)]);
      const Eigen::Vector2f at = cell * Eigen::Vector2f(static_cast<float>(c) + 0.5F, static_cast<float>(r) + 0.5F);
      sum += weight;
      mean += weight * at;
      square += weight * at * at.transpose();
    }
  }
  mean /= sum;
  const Eigen::Matrix2f spread =
      square / sum - mean * mean.transpose() + cell * cell / 12.0F * Eigen::Matrix2f::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> axes(spread);
  Upright upright{mean, Eigen::Vector2f::Zero()};
  if (axes.eigenvalues()(0) < kLineShare * axes.eigenvalues()(1)) upright.normal = axes.eigenvectors().col(0);
  return upright;
}

void add_heights(const Around<MapTile>& tiles, FieldTile& field) {
  std::vector<float> known;
  for (int row = -1; row <= kCellsPerTile; ++row) {
    for (int column = -1; column <= kCellsPerTile; ++column) {
      const float height = CellAround(tiles, column, row).ground();
      field.height[static_cast<std::size_t>((row + 1) * FieldTile::kSide + column + 1)] = height;
      if (std::isfinite(height)) known.push_back(height);
    }
  }
  field.level = std::numeric_limits<float>::quiet_NaN();
  if (known.empty()) return;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  field.level = *middle;
}

void add_uprights(const Around<MapTile>& tiles, FieldTile& field) {
  HitWindow hits{};
  for (int row = -kMargin; row < kCellsPerTile + kMargin; ++row) {
    for (int column = -kMargin; column < kCellsPerTile + kMargin; ++column)
      hits[place(column, row)] = CellAround(tiles, column, row).hits();
  }
  constexpr int kReach = FieldTile::kReach;
  std::array<int, semantic_map::tile::kCellsInTile> distance{};
  distance.fill(kReach * kReach + 1);
  for (int row = -kReach; row < kCellsPerTile + kReach; ++row) {
    for (int column = -kReach; column < kCellsPerTile + kReach; ++column) {
      if (hits[place(column, row)] == 0) continue;
      field.uprights.push_back(upright_at(hits, column, row));
      for (int r = std::max(0, row - kReach); r <= std::min(kCellsPerTile - 1, row + kReach); ++r) {
        for (int c = std::max(0, column - kReach); c <= std::min(kCellsPerTile - 1, column + kReach); ++c) {
          const int away = (r - row) * (r - row) + (c - column) * (c - column);
          const auto i = static_cast<std::size_t>(r * kCellsPerTile + c);
          if (away >= distance[i]) continue;
          distance[i] = away;
          field.nearest[i] = static_cast<std::uint16_t>(field.uprights.size());
        }
      }
    }
  }
}

void add_curbs(const Around<MapTile>& tiles, FieldTile& field) {
  constexpr int kReach = FieldTile::kReach;
  for (int row = -kReach; row < kCellsPerTile + kReach; ++row) {
    for (int column = -kReach; column < kCellsPerTile + kReach; ++column) {
      if (!CellAround(tiles, column, row).is_curb()) continue;
      for (int r = std::max(0, row - kReach); r <= std::min(kCellsPerTile - 1, row + kReach); ++r) {
        for (int c = std::max(0, column - kReach); c <= std::min(kCellsPerTile - 1, column + kReach); ++c)
          field.by_curb.set(static_cast<std::size_t>(r * kCellsPerTile + c));
      }
    }
  }
}

}  // namespace

bool shows_ground(const MapTile& tile, std::size_t cell) {
  const CellClass what = tile.cell_class[cell];
  return (what == CellClass::kRoad || what == CellClass::kCurb) && tile.height[cell] != MapTile::kNoHeight;
}

int upright_hits(const MapTile& tile, std::size_t cell) {
  const CellClass what = tile.cell_class[cell];
  const int hits = tile.hits[cell];
  return (what == CellClass::kWall || what == CellClass::kObstacle) && hits >= kMinHits ? hits : 0;
}

FieldTile make_field_tile(const Around<MapTile>& tiles) {
  FieldTile field;
  add_heights(tiles, field);
  add_uprights(tiles, field);
  add_curbs(tiles, field);
  return field;
}

}  // namespace curbstone::localizer::fields
