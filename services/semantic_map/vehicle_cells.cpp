#include "services/semantic_map/vehicle_cells.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace curbstone {

namespace {

constexpr int kWindow = 3 * kCellsPerTile;  // cells
constexpr int kHighCells = 10;              // as high as `min_vehicle`: less is a post or a bin
constexpr double kMaxLength = 7.0;          // m
constexpr double kMaxWidth = 2.6;           // m
constexpr double kMinLength = 1.2;          // m: one side of a small car seen from behind

using CellPlace = Eigen::Vector2i;  // in the window

/// What stands connected, cell by cell.
struct Thing {
  std::vector<CellPlace> cells;
  int high = 0;
};

class StandingCells {
 public:
  explicit StandingCells(const Around<CellColumns>& columns) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const CellColumns* tile = columns.at(dx, dy);
        if (tile == nullptr || tile->blocked.none()) continue;
        for (int i = 0; i < kCellsInTile; ++i) {
          const auto cell = static_cast<std::size_t>(i);
          if (!tile->blocked[cell]) continue;
          const CellPlace at((dx + 1) * kCellsPerTile + i % kCellsPerTile,
                             (dy + 1) * kCellsPerTile + i / kCellsPerTile);
          state_[index(at)] = tile->high[cell] ? kHigh : kLow;
          places_.push_back(at);
        }
      }
    }
  }
  /// Where anything stood at first.
  [[nodiscard]] const std::vector<CellPlace>& places() const { return places_; }

  /// Takes everything connected to a cell out of the window; nothing if nothing stands there.
  Thing take(CellPlace start) {
    Thing thing;
    take_cell(start, thing);
    for (std::size_t k = 0; k < thing.cells.size(); ++k) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) take_cell(CellPlace(thing.cells[k].x() + dx, thing.cells[k].y() + dy), thing);
      }
    }
    return thing;
  }

 private:
  enum State : std::uint8_t { kNothing, kLow, kHigh };
  static std::size_t index(CellPlace at) { return static_cast<std::size_t>(at.y() * kWindow + at.x()); }
  void take_cell(CellPlace at, Thing& thing) {
    if ((at.array() < 0).any() || (at.array() >= kWindow).any() || state_[index(at)] == kNothing) return;
    thing.cells.push_back(at);
    thing.high += state_[index(at)] == kHigh ? 1 : 0;
    state_[index(at)] = kNothing;
  }
  std::vector<State> state_ = std::vector<State>(static_cast<std::size_t>(kWindow * kWindow), kNothing);
  std::vector<CellPlace> places_;
};

/// Length and width along its principal axes.
bool is_vehicle(const Thing& thing) {
  if (thing.high < kHighCells) return false;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const CellPlace& at : thing.cells) mean += at.cast<double>() / static_cast<double>(thing.cells.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const CellPlace& at : thing.cells) {
    const Eigen::Vector2d d = at.cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scatter);
  Eigen::Vector2d least = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d most = -least;
  for (const CellPlace& at : thing.cells) {
    const Eigen::Vector2d along = axes.eigenvectors().transpose() * (at.cast<double>() - mean);
    least = least.cwiseMin(along);
    most = most.cwiseMax(along);
  }
  const Eigen::Vector2d size = kCellSize * (most - least + Eigen::Vector2d::Ones());  // width, length
  return size.maxCoeff() >= kMinLength && size.maxCoeff() <= kMaxLength && size.minCoeff() <= kMaxWidth;
}

int turn(CellPlace a, CellPlace b, CellPlace c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<CellPlace> outline(std::vector<CellPlace> cells) {
  std::sort(cells.begin(), cells.end(),
            [](const CellPlace& a, const CellPlace& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  std::vector<CellPlace> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const CellPlace& at : cells) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), at) <= 0) hull.pop_back();
      hull.push_back(at);
    }
    hull.pop_back();
    std::reverse(cells.begin(), cells.end());
  }
  return hull;
}

bool is_inside(const std::vector<CellPlace>& hull, CellPlace at) {
  for (std::size_t k = 0; k < hull.size(); ++k) {
    if (turn(hull[k], hull[(k + 1) % hull.size()], at) < 0) return false;
  }
  return hull.size() >= 3;
}

}  // namespace

VehicleCells find_vehicles(const Around<CellColumns>& columns) {
  VehicleCells vehicles;
  std::size_t num_high = 0;
  columns.for_each([&](const CellColumns& tile, double, double) { num_high += tile.high.count(); });
  if (num_high < kHighCells) return vehicles;
  StandingCells standing(columns);
  const auto in_tile = [](CellPlace at) {
    return static_cast<std::size_t>((at.y() - kCellsPerTile) * kCellsPerTile + at.x() - kCellsPerTile);
  };
  for (const CellPlace& place : standing.places()) {
    const Thing thing = standing.take(place);
    if (!is_vehicle(thing)) continue;
    const std::vector<CellPlace> hull = outline(thing.cells);
    for (int row = kCellsPerTile; row < 2 * kCellsPerTile; ++row) {
      for (int column = kCellsPerTile; column < 2 * kCellsPerTile; ++column) {
        const CellPlace at(column, row);
        if (is_inside(hull, at)) vehicles.beneath.set(in_tile(at));
      }
    }
  }
  return vehicles;
}

}  // namespace curbstone
