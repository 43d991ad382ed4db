#include "services/semantic_map/cells/vehicle_cells.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace curbstone::semantic_map::cells {

namespace {

constexpr int kWindow = 3 * kCellsPerTile;  // cells
constexpr int kHighCells = 10;              // as high as `min_vehicle`: less is a post or a bin

using CellPlace = VehicleOutline::Cell;  // from the centre tile's corner

/// Connected components of standing cells.
struct Thing {
  std::vector<CellPlace> cells;
  int high = 0;
};

class StandingCells {
 public:
  explicit StandingCells(const tile::Around<CellColumns>& columns) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const CellColumns* tile = columns.at(dx, dy);
        if (tile == nullptr) continue;
        for (std::size_t cell = tile->blocked._Find_first(); cell < tile::kCellsInTile;
             cell = tile->blocked._Find_next(cell)) {
          const auto i = static_cast<int>(cell);
          const CellPlace at(dx * kCellsPerTile + i % kCellsPerTile, dy * kCellsPerTile + i / kCellsPerTile);
          state_[index(at)] = tile->high[cell] ? kHigh : kLow;
          places_.push_back(at);
        }
      }
    }
  }
  /// The standing cells before any was taken.
  [[nodiscard]] const std::vector<CellPlace>& places() const { return places_; }

  /// Removes all cells connected to a cell from the window and returns them; nothing if the cell is empty.
  Thing take(CellPlace start) {
    Thing thing;
    take_cell(start, thing);
    for (std::size_t k = 0; k < thing.cells.size(); ++k) {
      const CellPlace here = thing.cells[k];
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) take_cell(CellPlace(here.x() + dx, here.y() + dy), thing);
      }
    }
    return thing;
  }

 private:
  enum State : std::uint8_t { kNothing, kLow, kHigh };
  static constexpr int kRow = kWindow + 2;  ///< with a cell beyond the window on each side, where nothing stands
  static std::size_t index(CellPlace at) {
    return static_cast<std::size_t>((at.y() + kCellsPerTile + 1) * kRow + at.x() + kCellsPerTile + 1);
  }
  void take_cell(CellPlace at, Thing& thing) {
    State& state = state_[index(at)];
    if (state == kNothing) return;
    thing.cells.push_back(at);
    thing.high += state == kHigh ? 1 : 0;
    state = kNothing;
  }
  std::array<State, static_cast<std::size_t>(kRow* kRow)> state_{};
  std::vector<CellPlace> places_;
};

/// Shortcut: most tiles have nothing as high as a vehicle nearby.
bool may_hold_vehicles(const tile::Around<CellColumns>& columns) {
  std::size_t num_high = 0;
  columns.for_each([&](const CellColumns& tile, double, double) { num_high += tile.high.count(); });
  return num_high >= kHighCells;
}

/// The cell nearest to the middle of the cells' extent; of several the first by row and column.
CellPlace middle_cell(const std::vector<CellPlace>& cells) {
  CellPlace least = cells.front();
  CellPlace most = cells.front();
  for (const CellPlace& at : cells) {
    least = least.cwiseMin(at);
    most = most.cwiseMax(at);
  }
  const auto order = [&](const CellPlace& at) {
    return std::tuple((2 * at - least - most).squaredNorm(), at.y(), at.x());
  };
  return *std::min_element(cells.begin(), cells.end(),
                           [&](const CellPlace& a, const CellPlace& b) { return order(a) < order(b); });
}

bool is_in_tile(CellPlace at) {
  return (at.array() >= 0).all() && (at.array() < kCellsPerTile).all();
}

}  // namespace

std::vector<VehicleOutline> find_vehicles(const tile::Around<CellColumns>& columns) {
  std::vector<VehicleOutline> vehicles;
  if (!may_hold_vehicles(columns)) return vehicles;
  StandingCells standing(columns);
  for (const CellPlace& place : standing.places()) {
    const Thing thing = standing.take(place);
    if (thing.high < kHighCells || !is_in_tile(middle_cell(thing.cells))) continue;
    if (auto outline = VehicleOutline::of(thing.cells)) vehicles.push_back(std::move(*outline));
  }
  return vehicles;
}

VehicleCells cover_vehicles(const tile::Around<std::vector<VehicleOutline>>& vehicles) {
  VehicleCells covered;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (vehicles.at(dx, dy) == nullptr) continue;
      const CellPlace corner(dx * kCellsPerTile, dy * kCellsPerTile);
      for (const VehicleOutline& outline : *vehicles.at(dx, dy)) {
        const CellPlace least = (outline.least() + corner).cwiseMax(0);
        const CellPlace most = (outline.most() + corner).cwiseMin(kCellsPerTile - 1);
        for (int row = least.y(); row <= most.y(); ++row) {
          for (int column = least.x(); column <= most.x(); ++column) {
            if (outline.contains(CellPlace(column, row) - corner))
              covered.beneath.set(static_cast<std::size_t>(row * kCellsPerTile + column));
          }
        }
      }
    }
  }
  return covered;
}

}  // namespace curbstone::semantic_map::cells
