#include "services/semantic_map/cells/vehicle_cells.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/semantic_map/cells/vehicle_outline.hpp"

namespace curbstone::semantic_map::cells {

namespace {

constexpr int kWindow = 3 * kCellsPerTile;  // cells
constexpr std::size_t kMaxTiles = 512;      // 1.6 kB each; tiles with vehicles in sight are fewer
constexpr int kHighCells = 10;              // as high as `min_vehicle`: less is a post or a bin

using CellPlace = VehicleOutline::Cell;  // in the window

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
          const CellPlace at((dx + 1) * kCellsPerTile + i % kCellsPerTile,
                             (dy + 1) * kCellsPerTile + i / kCellsPerTile);
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
  static std::size_t index(CellPlace at) { return static_cast<std::size_t>((at.y() + 1) * kRow + at.x() + 1); }
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

VehicleCells find_among(const tile::Around<CellColumns>& columns) {
  VehicleCells vehicles;
  StandingCells standing(columns);
  const auto in_tile = [](CellPlace at) {
    return static_cast<std::size_t>((at.y() - kCellsPerTile) * kCellsPerTile + at.x() - kCellsPerTile);
  };
  for (const CellPlace& place : standing.places()) {
    const Thing thing = standing.take(place);
    if (thing.high < kHighCells) continue;
    const auto outline = VehicleOutline::of(thing.cells);
    if (!outline) continue;
    for (int row = kCellsPerTile; row < 2 * kCellsPerTile; ++row) {
      for (int column = kCellsPerTile; column < 2 * kCellsPerTile; ++column) {
        const CellPlace at(column, row);
        if (outline->contains(at)) vehicles.beneath.set(in_tile(at));
      }
    }
  }
  return vehicles;
}

StandingAround standing_around(const tile::Around<CellColumns>& columns) {
  StandingAround around;
  std::size_t i = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx, i += 2) {
      const CellColumns* const tile = columns.at(dx, dy);
      if (tile == nullptr) continue;
      around[i] = tile->blocked;
      around[i + 1] = tile->high;
    }
  }
  return around;
}

/// Shortcut: most tiles have nothing as high as a vehicle nearby.
bool may_hold_vehicles(const tile::Around<CellColumns>& columns) {
  std::size_t num_high = 0;
  columns.for_each([&](const CellColumns& tile, double, double) { num_high += tile.high.count(); });
  return num_high >= kHighCells;
}

}  // namespace

VehicleCells find_vehicles(const tile::Around<CellColumns>& columns) {
  return may_hold_vehicles(columns) ? find_among(columns) : VehicleCells{};
}

VehicleCells VehicleCache::find(TileKey key, const tile::Around<CellColumns>& columns) {
  if (!may_hold_vehicles(columns)) return {};
  const StandingAround around = standing_around(columns);
  const auto it = found_.find(key);
  if (it != found_.end() && it->second.around == around) return it->second.vehicles;
  if (it == found_.end() && found_.size() >= kMaxTiles) found_.clear();
  const VehicleCells vehicles = find_among(columns);
  found_.insert_or_assign(key, Found{around, vehicles});
  return vehicles;
}

}  // namespace curbstone::semantic_map::cells
