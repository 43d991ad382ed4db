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
constexpr float kEdge = 0.08F;       // slope: 7 sigma of level ground if the heights have 1 cm of noise
constexpr float kMinCells = 12;      // of 25, that show ground
constexpr int kAxes = 255;           // directions of a rise, in half a turn
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

/// Slope of the plane through the heights around a cell; zero where too little ground was seen.
Eigen::Vector2f slope_about(const FieldTile& field, int column, int row) {
  Eigen::Matrix3f square = Eigen::Matrix3f::Zero();
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int r = std::max(-1, row - kPatch); r <= std::min(kCellsPerTile, row + kPatch); ++r) {
    for (int c = std::max(-1, column - kPatch); c <= std::min(kCellsPerTile, column + kPatch); ++c) {
      const float height = field.height_of(c, r);
      if (!std::isfinite(height)) continue;
      const Eigen::Vector3f at(static_cast<float>(c - column), static_cast<float>(r - row), 1);
      square += at * at.transpose();
      sum += (height - field.level) * at;
    }
  }
  if (square(2, 2) < kMinCells) return Eigen::Vector2f::Zero();
  return square.ldlt().solve(sum).head<2>() / static_cast<float>(kCellSize);
}

/// The value of FieldTile::rise for an axis: 1 to 255 for angles from -pi/2 to pi/2.
std::uint8_t axis_along(const Eigen::Vector2f& direction) {
  const double angle = std::atan(double{direction.y()} / double{direction.x()});
  return static_cast<std::uint8_t>(1 + std::lround((angle + M_PI_2) / M_PI * kAxes) % kAxes);
}

/// Finds the edges of the ground. Their direction is that of the ground around: that of one cell has the noise of its
/// heights, which along a straight curb would look like knowledge of the place.
void add_edges(FieldTile& field) {
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const Eigen::Vector2f slope = slope_about(field, column, row);
      if (slope.norm() > kEdge) field.rise[static_cast<std::size_t>(row * kCellsPerTile + column)] = axis_along(slope);
    }
  }
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

const Eigen::Vector2d& rise_of(std::uint8_t axis) {
  static const auto axes = [] {
    std::array<Eigen::Vector2d, kAxes + 1> all;
    all[0].setZero();
    for (int i = 0; i < kAxes; ++i) {
      const double angle = i * M_PI / kAxes - M_PI_2;
      all[static_cast<std::size_t>(i + 1)] = {std::cos(angle), std::sin(angle)};
    }
    return all;
  }();
  return axes[axis];
}

bool shows_ground(const MapTile& tile, std::size_t cell) {
  const CellClass what = tile.cell_class[cell];
  if (what != CellClass::kRoad && what != CellClass::kCurb) return false;
  return !tile.is_interpolated(cell) && tile.height[cell] != MapTile::kNoHeight;
}

int upright_hits(const MapTile& tile, std::size_t cell) {
  const CellClass what = tile.cell_class[cell];
  const int hits = tile.hits[cell];
  return (what == CellClass::kWall || what == CellClass::kObstacle) && hits >= kMinHits ? hits : 0;
}

FieldTile make_field_tile(const Around<MapTile>& tiles) {
  FieldTile field;
  add_heights(tiles, field);
  add_edges(field);
  add_uprights(tiles, field);
  add_curbs(tiles, field);
  return field;
}

}  // namespace curbstone::localizer::fields
