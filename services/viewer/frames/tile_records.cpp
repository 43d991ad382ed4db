#include "services/viewer/frames/tile_records.hpp"

#include <array>

namespace curbstone::viewer::frames {
namespace {

using store::kCellsInTile;
using store::TileCells;

enum Form : std::uint8_t { kWhole = 0, kChanges = 1 };

constexpr std::size_t kMaskBytes = (kCellsInTile + 7) / 8;
constexpr std::size_t kCellBytes = 5;

void write_head(ByteWriter& out, TileKey key, Form form, const TileCells& cells) {
  out.i32(key.x);
  out.i32(key.y);
  out.u8(form);
  out.i32(cells.revision);
  out.f64(static_cast<double>(cells.utime));
  out.f64(static_cast<double>(cells.curbs_utime));
  out.f32(cells.z_origin);
}

bool is_same_cell(const TileCells& a, const TileCells& b, std::size_t i) {
  return a.cell_class[i] == b.cell_class[i] && a.height[i] == b.height[i] && a.cost[i] == b.cost[i] &&
         a.confidence[i] == b.confidence[i];
}

}  // namespace

void write_tile(ByteWriter& out, TileKey key, const TileCells& cells) {
  write_head(out, key, kWhole, cells);
  out.bytes(cells.cell_class);
  for (const std::int16_t height : cells.height) out.i16(height);
  out.bytes(cells.cost);
  out.bytes(cells.confidence);
}

void write_changes(ByteWriter& out, TileKey key, const TileCells& before, const TileCells& cells) {
  std::array<std::uint8_t, kMaskBytes> mask{};
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < kCellsInTile; ++i) {
    if (is_same_cell(before, cells, i)) continue;
    mask[i / 8] = static_cast<std::uint8_t>(mask[i / 8] | 1U << (i % 8));
    changed.push_back(i);
  }
  const bool is_shorter = kMaskBytes + kCellBytes * changed.size() < kCellBytes * kCellsInTile;
  if (before.z_origin != cells.z_origin || !is_shorter) {
    write_tile(out, key, cells);
    return;
  }
  write_head(out, key, kChanges, cells);
  out.bytes(mask);
  for (const std::size_t i : changed) out.u8(cells.cell_class[i]);
  for (const std::size_t i : changed) out.i16(cells.height[i]);
  for (const std::size_t i : changed) out.u8(cells.cost[i]);
  for (const std::size_t i : changed) out.u8(cells.confidence[i]);
}

}  // namespace curbstone::viewer::frames
