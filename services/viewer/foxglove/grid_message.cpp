#include "services/viewer/foxglove/grid_message.hpp"

#include <foxglove/packed.pb.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>

#include "common/bytes/little_endian.hpp"
#include "services/viewer/foxglove/message_parts.hpp"

namespace curbstone::viewer::foxglove {
namespace {

using store::TileCells;
using Field = ::foxglove::PackedElementField;

constexpr std::size_t kCellBytes = 12;
constexpr std::size_t kElevation = 4;  // offsets in a cell
constexpr std::size_t kClass = 8;
constexpr std::size_t kCost = 9;
constexpr std::size_t kConfidence = 10;

struct Look {
  std::array<std::uint8_t, 4> colour;  // red, green, blue, alpha
  int rank;                            // the highest counts where cells are merged
};
/// By class.
constexpr std::array<Look, 5> kLooks = {{
    {{0, 0, 0, 0}, 0},
    {{140, 140, 140, 255}, 1},
    {{0, 200, 60, 255}, 4},
    {{20, 20, 20, 255}, 2},
    {{220, 40, 40, 255}, 3},
}};

/// A range of map cells; `scale` of them along a side make one cell of the grid.
struct Layout {
  std::int64_t column0 = 0;  // cells of the map
  std::int64_t row0 = 0;
  std::int64_t columns = 0;  // of the grid
  std::int64_t rows = 0;
  std::int64_t scale = 1;
};

class Raster {
 public:
  explicit Raster(const Layout& layout)
      : layout_(layout), bytes_(static_cast<std::size_t>(layout.columns * layout.rows) * kCellBytes, '\0') {
    for (std::size_t at = 0; at < bytes_.size(); at += kCellBytes) {
      set_elevation(at, std::numeric_limits<float>::quiet_NaN());
      bytes_[at + kCost] = static_cast<char>(255);
    }
  }

  void draw(TileKey key, const TileCells& tile) {
    for (std::size_t i = 0; i < store::kCellsInTile; ++i) {
      const std::int64_t column = std::int64_t{key.x} * kCellsPerTile + static_cast<std::int64_t>(i % kCellsPerTile);
      const std::int64_t row = std::int64_t{key.y} * kCellsPerTile + static_cast<std::int64_t>(i / kCellsPerTile);
      const std::int64_t x = (column - layout_.column0) / layout_.scale;
      const std::int64_t y = (row - layout_.row0) / layout_.scale;
      if (column < layout_.column0 || row < layout_.row0 || x >= layout_.columns || y >= layout_.rows) continue;
      draw_cell(static_cast<std::size_t>(y * layout_.columns + x) * kCellBytes, tile, i);
    }
  }

  [[nodiscard]] std::string message(std::int64_t utime) {
    ::foxglove::Grid grid;
    set_time(*grid.mutable_timestamp(), utime);
    grid.set_frame_id("map");
    const double cell = kCellSize * static_cast<double>(layout_.scale);
    Pose corner = Pose::Identity();
    corner.translation() = Eigen::Vector3d(static_cast<double>(layout_.column0) * kCellSize,
                                           static_cast<double>(layout_.row0) * kCellSize, road_height());
    set_pose(*grid.mutable_pose(), corner);
    grid.set_column_count(static_cast<std::uint32_t>(layout_.columns));
    grid.mutable_cell_size()->set_x(cell);
    grid.mutable_cell_size()->set_y(cell);
    grid.set_row_stride(static_cast<std::uint32_t>(static_cast<std::size_t>(layout_.columns) * kCellBytes));
    grid.set_cell_stride(kCellBytes);
    constexpr std::array kColours = {"red", "green", "blue", "alpha"};
    for (std::uint32_t i = 0; i < kColours.size(); ++i) add_field(grid, kColours[i], i, Field::UINT8);
    add_field(grid, "elevation", kElevation, Field::FLOAT32);
    add_field(grid, "class", kClass, Field::UINT8);
    add_field(grid, "cost", kCost, Field::UINT8);
    add_field(grid, "confidence", kConfidence, Field::UINT8);
    grid.set_data(std::move(bytes_));
    return grid.SerializeAsString();
  }

 private:
  void draw_cell(std::size_t at, const TileCells& tile, std::size_t i) {
    const std::uint8_t cell_class = tile.cell_class[i];
    const Look& look = kLooks[cell_class];
    const bool is_known = tile.height[i] != semantic_tile_t::NO_HEIGHT;
    const double height = double{tile.z_origin} + tile.height[i] * kPositionStep;
    if (cell_class == semantic_tile_t::ROAD && is_known) {
      road_sum_ += height;
      ++roads_;
    }
    if (look.rank < kLooks[static_cast<std::uint8_t>(bytes_[at + kClass])].rank) return;
    for (std::size_t k = 0; k < look.colour.size(); ++k) bytes_[at + k] = static_cast<char>(look.colour[k]);
    if (is_known) set_elevation(at, static_cast<float>(height));
    bytes_[at + kClass] = static_cast<char>(cell_class);
    bytes_[at + kCost] = static_cast<char>(tile.cost[i]);
    bytes_[at + kConfidence] = static_cast<char>(tile.confidence[i]);
  }
  void set_elevation(std::size_t at, float value) {
    const std::span<std::uint8_t> cell(reinterpret_cast<std::uint8_t*>(bytes_.data()) + at, kCellBytes);
    write_little_endian(cell.subspan(kElevation), std::bit_cast<std::uint32_t>(value));
  }
  [[nodiscard]] double road_height() const { return roads_ == 0 ? 0 : road_sum_ / static_cast<double>(roads_); }

  Layout layout_;
  std::string bytes_;
  double road_sum_ = 0;  // m
  std::int64_t roads_ = 0;
};

}  // namespace

std::string window_grid(const store::LiveMap& map, TileKey middle, std::int64_t utime) {
  const std::int64_t left = std::int64_t{middle.x} - kWindowTiles / 2;
  const std::int64_t bottom = std::int64_t{middle.y} - kWindowTiles / 2;
  constexpr std::int64_t kCells = kWindowTiles * kCellsPerTile;
  Raster raster({left * kCellsPerTile, bottom * kCellsPerTile, kCells, kCells, 1});
  for (int y = 0; y < kWindowTiles; ++y) {
    for (int x = 0; x < kWindowTiles; ++x) {
      const TileKey key{static_cast<std::int32_t>(left + x), static_cast<std::int32_t>(bottom + y)};
      if (const TileCells* tile = map.at(key)) raster.draw(key, *tile);
    }
  }
  return raster.message(utime);
}

std::string whole_grid(const store::LiveMap& map, std::int64_t utime) {
  const auto tiles = map.above(0, store::LiveMap::kMaxTiles);
  if (tiles.empty()) return {};
  const auto [left, right] =
      std::minmax_element(tiles.begin(), tiles.end(), [](const auto& a, const auto& b) { return a.key.x < b.key.x; });
  const auto [bottom, top] =
      std::minmax_element(tiles.begin(), tiles.end(), [](const auto& a, const auto& b) { return a.key.y < b.key.y; });
  const std::int64_t wide = (std::int64_t{right->key.x} - left->key.x + 1) * kCellsPerTile;
  const std::int64_t high = (std::int64_t{top->key.y} - bottom->key.y + 1) * kCellsPerTile;
  if (std::max(wide, high) > std::numeric_limits<std::int32_t>::max()) return {};
  std::int64_t scale = 1;
  const auto along = [&](std::int64_t cells) { return (cells + scale - 1) / scale; };
  while (along(wide) * along(high) > kMaxWholeCells) ++scale;
  Raster raster({std::int64_t{left->key.x} * kCellsPerTile, std::int64_t{bottom->key.y} * kCellsPerTile, along(wide),
                 along(high), scale});
  for (const auto& tile : tiles) raster.draw(tile.key, *tile.cells);
  return raster.message(utime);
}

}  // namespace curbstone::viewer::foxglove
