#include "tools/bench/markings/marking_picture.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>

#include "services/semantic_map/picture/canvas.hpp"
#include "services/semantic_map/picture/png_file.hpp"

namespace curbstone::bench::markings {
namespace {

using semantic_map::picture::Canvas;
using semantic_map::picture::Colour;

constexpr int kPixels = 6;      // per cell
constexpr int kMaxCells = 700;  // per side
constexpr std::array<Colour, semantic_map::tile::kNumMarkingTypes> kColours = {
    {{90, 120, 255}, {40, 230, 60}, {40, 220, 230}, {255, 150, 30}, {250, 240, 40}, {255, 50, 30}}};

}  // namespace

void draw_markings(const std::vector<semantic_map::tile::VotedTile>& tiles, const PaintCells& painted,
                   const std::vector<semantic_map::tile::MarkingLine>& lines, const std::string& file) {
  struct Sum {
    double intensity = 0;
    int count = 0;
  };
  std::unordered_map<TileKey, Sum, TileKeyHash> cells;
  TileKey low{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()};
  TileKey high{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()};
  for (const auto& tile : tiles) {
    if (tile.intensity.size() != tile.points.size()) continue;
    for (std::size_t i = 0; i < tile.points.size(); ++i) {
      const auto& p = tile.points[i];
      if (p.normal.z() < 0.8F || tile.intensity[i] == 0) continue;
      const TileKey at = cell_of({tile.key.x * kTileSize + double{p.x}, tile.key.y * kTileSize + double{p.y}});
      cells[at].intensity += tile.intensity[i];
      ++cells[at].count;
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
  }
  if (cells.empty()) return;
  const TileKey middle{(low.x + high.x) / 2, (low.y + high.y) / 2};
  low = {std::max(low.x, middle.x - kMaxCells / 2), std::max(low.y, middle.y - kMaxCells / 2)};
  high = {std::min(high.x, middle.x + kMaxCells / 2), std::min(high.y, middle.y + kMaxCells / 2)};
  Canvas canvas((high.x - low.x + 1) * kPixels, (high.y - low.y + 1) * kPixels, {20, 30, 26});
  for (const auto& [at, sum] : cells) {
    const auto grey = static_cast<std::uint8_t>(std::min(255.0, 1.4 * sum.intensity / sum.count));
    canvas.fill((at.x - low.x) * kPixels, (high.y - at.y) * kPixels, kPixels, kPixels, {grey, grey, grey});
  }
  for (const TileKey& at : painted)
    canvas.fill((at.x - low.x) * kPixels + 2, (high.y - at.y) * kPixels + 2, 2, 2, {255, 0, 200});
  for (const auto& line : lines) {
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const auto pixel = [&](const semantic_map::tile::MarkingVertex& v) {
        return Eigen::Vector2d((double{v.x} / kCellSize - low.x) * kPixels,
                               (high.y + 1 - double{v.y} / kCellSize) * kPixels);
      };
      const Eigen::Vector2d a = pixel(line.points[i - 1]);
      const Eigen::Vector2d b = pixel(line.points[i]);
      canvas.line(a.x(), a.y(), b.x(), b.y(), line.points[i - 1].painted ? 2.0 : 0.7,
                  kColours[static_cast<std::size_t>(line.type)], 0.9);
    }
  }
  semantic_map::picture::write_png(canvas, file);
}

}  // namespace curbstone::bench::markings
