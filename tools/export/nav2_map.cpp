#include "tools/export/nav2_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/tiles/tile.hpp"

namespace curbstone::map_export {

namespace {

constexpr int kLethal = 254;  // the highest cost of a known cell

/// Decides by class, not by cost: a map made with `unknown_is_free` gives unknown cells cost 0. A cell with a class but
/// no cost is unknown too.
bool is_unknown(const MapGrid& grid, std::size_t i) {
  return grid.cell_class[i] == semantic_map::tile::CellClass::kUnknown || grid.cost[i] > kLethal;
}

}  // namespace

std::vector<std::uint8_t> trinary_pixels(const MapGrid& grid, const Nav2Policy& policy) {
  constexpr std::uint8_t kFree = 254;
  constexpr std::uint8_t kOccupied = 0;
  constexpr std::uint8_t kUnknown = 128;
  std::vector<std::uint8_t> pixels(grid.cell_class.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = int{grid.cost[i]} >= policy.occupied_cost ? kOccupied : kFree;
    if (!is_unknown(grid, i)) continue;
    pixels[i] = kUnknown;
    if (policy.unknown == UnknownCells::kOccupied) pixels[i] = kOccupied;
    if (policy.unknown == UnknownCells::kFree) pixels[i] = kFree;
  }
  return pixels;
}

std::vector<std::uint8_t> scale_pixels(const MapGrid& grid, const Nav2Policy& policy) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(2 * grid.cell_class.size());
  for (std::size_t i = 0; i < grid.cell_class.size(); ++i) {
    int cost = std::min<int>(grid.cost[i], kLethal);
    std::uint8_t alpha = 255;
    if (is_unknown(grid, i)) {
      cost = policy.unknown == UnknownCells::kFree ? 0 : kLethal;
      if (policy.unknown == UnknownCells::kUnknown) alpha = 0;
    }
    pixels.push_back(static_cast<std::uint8_t>(255 - std::lround(255.0 * cost / kLethal)));
    pixels.push_back(alpha);
  }
  return pixels;
}

std::string nav2_yaml(const MapGrid& grid, const std::string& image, const std::string& mode) {
  const bool is_scale = mode == "scale";
  return fmt::format(
      "image: {}\nmode: {}\nresolution: {}\norigin: [{:.2f}, {:.2f}, 0]\nnegate: 0\noccupied_thresh: {}\nfree_thresh: "
      "{}\n",
      image, mode, kCellSize, grid.left(), grid.bottom(), is_scale ? "1.0" : "0.65", is_scale ? "0.0" : "0.25");
}

}  // namespace curbstone::map_export
