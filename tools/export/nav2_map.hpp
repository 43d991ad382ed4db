#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/export/map_grid.hpp"

namespace curbstone::map_export {

/// How cells that were never observed are written for nav2's map_server.
enum class UnknownCells {
  kOccupied,  ///< safe: no robot drives there, however the planner is configured
  kUnknown,   ///< the planner decides (nav2's planners drive through unknown cells unless allow_unknown is false)
  kFree,      ///< the paper's policy
};

struct Nav2Policy {
  UnknownCells unknown = UnknownCells::kOccupied;
  /// Trinary mode has no intermediate costs: cells of at least this cost are occupied. The default includes every curb
  /// (60 and more).
  int occupied_cost = 50;
};

// Pixels of a map for nav2's map_server with negate 0: occupancy = (255 - pixel) / 255.

/// Mode trinary, one byte per cell: free 254, occupied 0, unknown 128 (between the thresholds; 205, which many maps
/// use, is free by nav2's default of free_thresh).
[[nodiscard]] std::vector<std::uint8_t> trinary_pixels(const MapGrid& grid, const Nav2Policy& policy);
/// Mode scale, gray and alpha: occupancy increases with cost, 254 to 100. Unknown is transparent, as map_server
/// requires; a PGM cannot represent that.
[[nodiscard]] std::vector<std::uint8_t> scale_pixels(const MapGrid& grid, const Nav2Policy& policy);

/// map_server's YAML. `mode`: trinary or scale. Always in the frame map, in which the robot localises.
[[nodiscard]] std::string nav2_yaml(const MapGrid& grid, const std::string& image, const std::string& mode);

}  // namespace curbstone::map_export
