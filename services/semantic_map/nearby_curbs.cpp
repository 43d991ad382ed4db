#include "services/semantic_map/nearby_curbs.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "services/semantic_map/curb_lines/curb_bridges.hpp"
#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr std::size_t kMaxVertices = 1800;  // 24 bytes each: below 48 kB
constexpr double kSmaller = 0.7;            // of the range, where there are more

/// m in map.
struct Box {
  Eigen::Vector2d min;
  Eigen::Vector2d max;
  [[nodiscard]] bool contains(const Eigen::Vector2d& p) const {
    return (p.array() >= min.array()).all() && (p.array() <= max.array()).all();
  }
  [[nodiscard]] bool meets_tile_at(const Eigen::Vector2d& corner) const {
    return (corner.array() + kTileSize >= min.array()).all() && (corner.array() <= max.array()).all();
  }
};

std::vector<curb_lines::MapCurbPoint> points_in(const Box& box, const TilePipeline& pipeline) {
  std::vector<curb_lines::MapCurbPoint> points;
  for (const TileKey& key : pipeline.keys()) {
    const Eigen::Vector2d corner(key.x * kTileSize, key.y * kTileSize);
    if (!box.meets_tile_at(corner)) continue;
    for (const curbs::CurbPoint& p : *pipeline.curbs(key)) {
      const Eigen::Vector2d foot = p.foot + corner;
      if (box.contains(foot)) points.push_back({foot, p.up, p.z, p.height, p.confidence, p.weak, p.reach});
    }
  }
  return points;
}

/// Where a cell shows ground.
std::optional<double> ground_at(const TilePipeline& pipeline, const Eigen::Vector2d& at) {
  const auto key = tile_at(at.x(), at.y());
  const tile::MapTile* tile = key ? pipeline.classes(*key) : nullptr;
  if (tile == nullptr) return std::nullopt;
  const auto cell_of = [](double x, std::int32_t tile_x) {
    return std::clamp(static_cast<int>((x - tile_x * kTileSize) / kCellSize), 0, kCellsPerTile - 1);
  };
  const auto i = static_cast<std::size_t>(cell_of(at.y(), key->y) * kCellsPerTile + cell_of(at.x(), key->x));
  const bool is_ground = tile->cell_class[i] == tile::CellClass::kRoad || tile->cell_class[i] == tile::CellClass::kCurb;
  if (!is_ground || tile->height[i] == tile::MapTile::kNoHeight) return std::nullopt;
  return double{tile->z_origin} + kPositionStep * tile->height[i];
}

std::vector<tile::CurbLine> lines_in(const Box& box, const TilePipeline& pipeline) {
  std::vector<tile::CurbLine> lines = curb_lines::link_curbs(points_in(box, pipeline));
  curb_lines::add_bridges([&](const Eigen::Vector2d& at) { return ground_at(pipeline, at); }, lines);
  return lines;
}

std::size_t num_vertices(const std::vector<tile::CurbLine>& lines) {
  std::size_t vertices = 0;
  for (const tile::CurbLine& line : lines) vertices += line.points.size() + 1;
  return vertices;
}

}  // namespace

std::vector<tile::CurbLine> all_curbs(const TilePipeline& pipeline) {
  constexpr double kAll = std::numeric_limits<double>::max();
  return lines_in({Eigen::Vector2d::Constant(-kAll), Eigen::Vector2d::Constant(kAll)}, pipeline);
}

curb_lines_t NearbyCurbs::next(const TilePipeline& pipeline, const Eigen::Vector2d& vehicle,
                               const std::vector<Eigen::Vector2d>& path) {
  double range = range_;
  const auto box_of = [&] { return Box{vehicle.array() - range, vehicle.array() + range}; };
  Box box = box_of();
  std::vector<tile::CurbLine> lines = lines_in(box, pipeline);
  while (num_vertices(lines) > kMaxVertices) {
    range *= kSmaller;
    box = box_of();
    lines = lines_in(box, pipeline);
  }
  ids_.assign(lines);
  curb_lines_t message;
  for (int axis = 0; axis < 2; ++axis) {
    message.box_min[axis] = static_cast<float>(box.min[axis]);
    message.box_max[axis] = static_cast<float>(box.max[axis]);
  }
  message.revision = ++revision_;
  message.num_lines = static_cast<std::int32_t>(lines.size());
  for (const tile::CurbLine& line : lines) message.lines.push_back(to_message(line, path));
  lines_ = std::move(lines);
  return message;
}

}  // namespace curbstone::semantic_map
