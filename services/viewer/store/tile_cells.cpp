#include "services/viewer/store/tile_cells.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::viewer::store {
namespace {

/// Bounds: the page's numbers have 53 bits, and its textures span some kilometres.
constexpr std::int32_t kMaxTile = 1'000'000;             // 3000 km
constexpr std::int64_t kLatest = 4'102'444'800'000'000;  // us: the year 2100

bool is_time(std::int64_t utime) {
  return utime >= 0 && utime <= kLatest;
}

bool is_near(std::int32_t tile) {
  return tile >= -kMaxTile && tile <= kMaxTile;
}

}  // namespace

std::optional<TileCells> cells_of(const semantic_tile_t& message) {
  const auto is_class = [](std::uint8_t c) { return c <= semantic_tile_t::WALL; };
  if (!is_time(message.utime) || !is_time(message.curbs_utime) || message.revision < 0) return std::nullopt;
  if (!std::isfinite(message.z_origin) || !is_near(message.tile_x) || !is_near(message.tile_y)) return std::nullopt;
  if (!std::all_of(std::begin(message.cell_class), std::end(message.cell_class), is_class)) return std::nullopt;
  TileCells cells{.utime = message.utime,
                  .curbs_utime = message.curbs_utime,
                  .revision = message.revision,
                  .z_origin = message.z_origin};
  std::copy(std::begin(message.cell_class), std::end(message.cell_class), cells.cell_class.begin());
  std::copy(std::begin(message.height), std::end(message.height), cells.height.begin());
  std::copy(std::begin(message.cost), std::end(message.cost), cells.cost.begin());
  std::copy(std::begin(message.confidence), std::end(message.confidence), cells.confidence.begin());
  return cells;
}

}  // namespace curbstone::viewer::store
