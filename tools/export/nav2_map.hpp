#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/export/map_grid.hpp"

namespace curbstone::map_export {

/// What never was seen, on the way to nav2's map_server.
enum class UnknownCells {
  kOccupied,  ///< safe: nobody drives there, whatever the planner is configured to do
  kUnknown,   ///< the planner decides (nav2's planners drive through unknown cells unless allow_unknown is false)
  kFree,      ///< the paper's policy
};

struct Nav2Policy {
  UnknownCells unknown = UnknownCells::kOccupied;
  /// Trinary has no "slowly": cells of this cost and more are occupied. The default takes every curb (60 and more).
  int occupied_cost = 50;
};

// Pixels of a map for nav2's map_server with negate 0: occupancy = (255 - pixel) / 255.

/// Mode trinary, one byte a cell: free 254, occupied 0, unknown 128 (between the thresholds; 205, which many maps use,
/// is free by nav2's own default of free_thresh).
[[nodiscard]] std::vector<std::uint8_t> trinary_pixels(const MapGrid& grid, const Nav2Policy& policy);
/// Mode scale, gray and alpha: occupancy grows with cost, 254 to 100; unknown is transparent, which is how map_server
/// wants it and why this is no PGM.
[[nodiscard]] std::vector<std::uint8_t> scale_pixels(const MapGrid& grid, const Nav2Policy& policy);

/// map_server's YAML. `mode`: trinary or scale. Always in map: the robot localises there.
[[nodiscard]] std::string nav2_yaml(const MapGrid& grid, const std::string& image, const std::string& mode);

}  // namespace curbstone::map_export
