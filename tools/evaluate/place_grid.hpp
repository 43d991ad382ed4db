#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::evaluate {

/// Points in the plane in a hash grid whose squares are as wide as the search radius.
template <class Place>
class PlaceGrid {
 public:
  PlaceGrid(const std::vector<Place>& places, double reach) : reach_(reach) {
    for (const Place& place : places) cells_[key(place.x, place.y)].push_back(place);
  }
  /// Whether any point is within the reach of (x, y).
  [[nodiscard]] bool any_near(double x, double y) const {
    const TileKey centre = key(x, y);
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        const auto it = cells_.find({centre.x + dx, centre.y + dy});
        if (it == cells_.end()) continue;
        for (const Place& place : it->second) {
          if (std::hypot(place.x - x, place.y - y) <= reach_) return true;
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] TileKey key(double x, double y) const {
    return {static_cast<std::int32_t>(std::floor(x / reach_)), static_cast<std::int32_t>(std::floor(y / reach_))};
  }
  double reach_;
  std::unordered_map<TileKey, std::vector<Place>, TileKeyHash> cells_;
};

}  // namespace curbstone::evaluate
