#include "services/semantic_map/map_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_set>
#include <utility>

#include "services/semantic_map/curb_lines/curb_bridges.hpp"
#include "services/semantic_map/curb_lines/curb_lines.hpp"
#include "services/semantic_map/marking_lines/marking_lines.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr double kSureLength = 5.0;  // m of paint: bright strips of a lawn are shorter

MapBox everything() {
  constexpr double kAll = std::numeric_limits<double>::max();
  return {Eigen::Vector2d::Constant(-kAll), Eigen::Vector2d::Constant(kAll)};
}

Eigen::Vector2d corner_of(TileKey key) {
  return {key.x * kTileSize, key.y * kTileSize};
}

/// The height of a cell in which ground was seen.
std::optional<double> ground_at(const TileLookup& tiles, const Eigen::Vector2d& at) {
  const auto key = tile_at(at.x(), at.y());
  const auto tile = key ? tiles(*key) : nullptr;
  if (tile == nullptr) return std::nullopt;
  const auto cell_of = [](double x, std::int32_t tile_x) {
    return std::clamp(static_cast<int>((x - tile_x * kTileSize) / kCellSize), 0, kCellsPerTile - 1);
  };
  const auto i = static_cast<std::size_t>(cell_of(at.y(), key->y) * kCellsPerTile + cell_of(at.x(), key->x));
  const bool is_ground = tile->cell_class[i] == tile::CellClass::kRoad || tile->cell_class[i] == tile::CellClass::kCurb;
  if (!is_ground || tile->is_interpolated(i) || tile->height[i] == tile::MapTile::kNoHeight) return std::nullopt;
  return double{tile->z_origin} + kPositionStep * tile->height[i];
}

void append_curb_points(TileKey key, const MapBox& box, const std::vector<curbs::CurbPoint>& of_tile,
                        std::vector<curb_lines::MapCurbPoint>& points) {
  for (const curbs::CurbPoint& p : of_tile) {
    const Eigen::Vector2d foot = p.foot + corner_of(key);
    if (box.contains(foot)) points.push_back({foot, p.up, p.z, p.height, p.confidence, p.weak, p.reach});
  }
}

void append_marking_cells(TileKey key, const MapBox& box, const std::vector<markings::MarkingCell>& of_tile,
                          std::vector<marking_lines::MapMarkingCell>& cells) {
  for (const markings::MarkingCell& cell : of_tile) {
    const Eigen::Vector2d at = corner_of(key) + Eigen::Vector2d(double{cell.x}, double{cell.y});
    if (box.contains(at))
      cells.push_back({at, cell.z, cell.contrast, cell.is_strong, cell.is_bright, cell.count, cell.level});
  }
}

/// The next tile along an axis; beyond the last one, the first: any key may come from the bus.
std::int32_t beside(std::int32_t tile, int step) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(tile) + static_cast<std::uint32_t>(step));
}

/// The tiles whose cells can belong to a marking: those with a strong cell, and their neighbours. A line follows strong
/// cells, and counts no others that are as far from them as a tile is wide.
std::unordered_set<TileKey, TileKeyHash> tiles_near_paint(const MapLineSources& sources) {
  std::unordered_set<TileKey, TileKeyHash> near;
  for (const auto& [key, tile] : sources.tiles) {
    if (std::ranges::none_of(*tile.markings, &markings::MarkingCell::is_strong)) continue;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) near.insert({beside(key.x, dx), beside(key.y, dy)});
    }
  }
  return near;
}

double painted_length(const tile::MarkingLine& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    const tile::MarkingVertex& a = line.points[i - 1];
    const tile::MarkingVertex& b = line.points[i];
    if (a.painted) length += std::hypot(double{b.x} - double{a.x}, double{b.y} - double{a.y});
  }
  return length;
}

/// Whether a kerb lies between the driven path and a line, as seen from two of three of its places: its ends and its
/// middle. Beyond a lowered kerb there are driveways and yards, or a road: only a crossing, or a line longer than any
/// bright strip of a lawn, is accepted there.
bool is_beyond_kerb(const tile::MarkingLine& line, const Kerbstones& kerbs, const tile::DrivenPath& path) {
  const bool is_sure = line.type == tile::MarkingType::kCrossing || painted_length(line) >= kSureLength;
  int beyond = 0;
  for (const std::size_t i : {std::size_t{0}, line.points.size() / 2, line.points.size() - 1}) {
    const Eigen::Vector2d at(double{line.points[i].x}, double{line.points[i].y});
    const auto road = path.nearest(at);
    if (!road) continue;
    const bool is_parted = kerbs.separates(*road, at, Kerbstones::Which::kRaised) ||
                           (!is_sure && kerbs.separates(*road, at, Kerbstones::Which::kAll));
    beyond += is_parted ? 1 : 0;
  }
  return beyond > 1;
}

/// Appends to `lines` the parts of `before` for which `keeps(tile)` is true.
template <class Line, class Keeps>
void keep_parts(const std::vector<Line>& before, Keeps keeps, std::vector<Line>& lines) {
  for (const Line& line : before) {
    Line part = line;
    part.points.clear();
    const auto end_part = [&] {
      part.id = static_cast<std::int32_t>(lines.size());
      if (part.points.size() > 1) lines.push_back(part);
      part.points.clear();
    };
    for (const auto& vertex : line.points) {
      const auto key = tile_at(double{vertex.x}, double{vertex.y});
      if (key && keeps(*key))
        part.points.push_back(vertex);
      else
        end_part();
    }
    end_part();
  }
}

}  // namespace

std::vector<curb_lines::MapCurbPoint> curb_points_in(const MapBox& box, const pipeline::TilePipeline& pipeline) {
  std::vector<curb_lines::MapCurbPoint> points;
  for (const TileKey& key : pipeline.keys_in(box.min(), box.max()))
    append_curb_points(key, box, *pipeline.curbs(key), points);
  return points;
}

std::vector<marking_lines::MapMarkingCell> marking_cells_in(const MapBox& box, const pipeline::TilePipeline& pipeline) {
  std::vector<marking_lines::MapMarkingCell> cells;
  for (const TileKey& key : pipeline.keys_in(box.min(), box.max()))
    append_marking_cells(key, box, *pipeline.markings(key), cells);
  return cells;
}

std::vector<tile::CurbLine> link_and_bridge_curbs(const std::vector<curb_lines::MapCurbPoint>& points,
                                                  const TileLookup& tiles) {
  std::vector<tile::CurbLine> lines = curb_lines::link_curbs(points);
  curb_lines::add_bridges([&](const Eigen::Vector2d& at) { return ground_at(tiles, at); }, lines);
  return lines;
}

std::vector<tile::MarkingLine> link_road_markings(std::vector<marking_lines::MapMarkingCell> cells,
                                                  const Kerbstones& kerbs, const tile::DrivenPath& path,
                                                  const markings::MarkingParameters& parameters,
                                                  const TileLookup& tiles) {
  for (marking_lines::MapMarkingCell& cell : cells) {
    if (cell.is_bright && kerbs.contains(cell.at)) cell.is_bright = cell.is_strong = false;
  }
  std::vector<tile::MarkingLine> lines = marking_lines::link_marking_cells(
      cells, path, parameters, [&](const Eigen::Vector2d& at) { return ground_at(tiles, at).has_value(); });
  std::erase_if(lines, [&](const tile::MarkingLine& line) { return is_beyond_kerb(line, kerbs, path); });
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].id = static_cast<std::int32_t>(i);
  return lines;
}

std::vector<tile::CurbLine> all_curbs(const pipeline::TilePipeline& pipeline) {
  return link_and_bridge_curbs(curb_points_in(everything(), pipeline),
                               [&](TileKey key) { return pipeline.classes(key); });
}

std::vector<tile::MarkingLine> all_markings(const pipeline::TilePipeline& pipeline,
                                            const std::vector<tile::CurbLine>& curbs, const tile::DrivenPath& path,
                                            const markings::MarkingParameters& parameters) {
  return link_road_markings(marking_cells_in(everything(), pipeline), Kerbstones(curbs), path, parameters,
                            [&](TileKey key) { return pipeline.classes(key); });
}

LineTile line_tile(TileKey key, const pipeline::TilePipeline& pipeline) {
  return {pipeline.curbs(key), pipeline.markings(key), pipeline.classes(key)};
}

MapLineSources line_sources(const pipeline::TilePipeline& pipeline, const tile::DrivenPath& path,
                            const markings::MarkingParameters& parameters) {
  MapLineSources sources;
  for (const TileKey& key : pipeline.keys()) sources.tiles.emplace(key, line_tile(key, pipeline));
  sources.path = path;
  sources.markings = parameters;
  return sources;
}

tile::MapLines link(const MapLineSources& sources) {
  std::vector<TileKey> keys;  // sorted: the order of tiles does not change the lines, but it changes their order
  keys.reserve(sources.tiles.size());
  for (const auto& [key, tile] : sources.tiles) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  const auto near_paint = tiles_near_paint(sources);
  std::vector<curb_lines::MapCurbPoint> points;
  std::vector<marking_lines::MapMarkingCell> cells;
  std::size_t num_cells = 0;
  for (const TileKey& key : keys) num_cells += near_paint.contains(key) ? sources.tiles.at(key).markings->size() : 0;
  cells.reserve(num_cells);
  for (const TileKey& key : keys) {
    const LineTile& tile = sources.tiles.at(key);
    append_curb_points(key, everything(), *tile.curbs, points);
    if (near_paint.contains(key)) append_marking_cells(key, everything(), *tile.markings, cells);
  }
  tile::MapLines lines;
  const auto classes = [&](TileKey key) {
    const auto it = sources.tiles.find(key);
    return it == sources.tiles.end() ? nullptr : it->second.classes;
  };
  lines.curbs = link_and_bridge_curbs(points, classes);
  lines.markings =
      link_road_markings(std::move(cells), Kerbstones(lines.curbs), sources.path, sources.markings, classes);
  if (sources.before) {
    const auto only_before = [&](TileKey key) {
      return sources.before->tiles.contains(key) && !sources.tiles.contains(key);
    };
    keep_parts(sources.before->lines.curbs, only_before, lines.curbs);
    keep_parts(sources.before->lines.markings, only_before, lines.markings);
  }
  return lines;
}

}  // namespace curbstone::semantic_map
