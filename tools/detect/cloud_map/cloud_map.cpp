#include "tools/detect/cloud_map/cloud_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_set>

#include "services/semantic_map/map_lines.hpp"
#include "services/tensor_voting/kernels/decomposition.hpp"
#include "services/tensor_voting/voting/batch_voting.hpp"

namespace curbstone::detect::cloud_map {

namespace {

struct Voxel {
  std::int64_t x, y, z;
  bool operator==(const Voxel&) const = default;
};
struct VoxelHash {
  std::size_t operator()(const Voxel& v) const noexcept {
    auto h = static_cast<std::uint64_t>(v.x) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ static_cast<std::uint64_t>(v.y)) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 29) ^ static_cast<std::uint64_t>(v.z)) * 0x94d049bb133111ebULL;
    return static_cast<std::size_t>(h ^ (h >> 31));
  }
};

/// Usable points of a cloud and their indices in it.
struct UsablePoints {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::size_t> indices;
};

UsablePoints usable_points(std::span<const Eigen::Vector3f> points, const CloudMapOptions& options, CloudMap& counts) {
  UsablePoints used;
  std::unordered_set<Voxel, VoxelHash> taken;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    if (!p.allFinite()) {
      ++counts.not_finite;
      continue;
    }
    if ((options.range > 0 && p.head<2>().norm() > options.range) || !tile_at(p.x(), p.y()) ||
        p.cwiseAbs().maxCoeff() > 1e6) {
      ++counts.out_of_range;
      continue;
    }
    const auto cell = [&](double x) { return static_cast<std::int64_t>(std::floor(x / options.thin)); };
    if (options.thin > 0 && !taken.insert({cell(p.x()), cell(p.y()), cell(p.z())}).second) continue;
    used.positions.push_back(p);
    used.indices.push_back(i);
  }
  return used;
}

/// A point takes its cell's class if it belongs to the layer that determined the cell's class.
semantic_map::tile::CellClass label_of(const semantic_map::tile::VotedPoint& p, const semantic_map::tile::MapTile& tile,
                                       const semantic_map::cells::ClassParameters& parameters) {
  const int column = std::clamp(static_cast<int>(double{p.x} / kCellSize), 0, kCellsPerTile - 1);
  const int row = std::clamp(static_cast<int>(double{p.y} / kCellSize), 0, kCellsPerTile - 1);
  const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
  const semantic_map::tile::CellClass c = tile.cell_class[i];
  if (tile.height[i] == semantic_map::tile::MapTile::kNoHeight) return semantic_map::tile::CellClass::kUnknown;
  const double above = double{p.z} - double{tile.z_origin} - tile.height[i] * kPositionStep;
  if (above > parameters.vehicle_height && c != semantic_map::tile::CellClass::kWall)
    return semantic_map::tile::CellClass::kUnknown;
  if (std::abs(above) <= parameters.ground_band &&
      (c == semantic_map::tile::CellClass::kObstacle || c == semantic_map::tile::CellClass::kWall))
    return semantic_map::tile::CellClass::kRoad;
  if (above > parameters.min_obstacle &&
      (c == semantic_map::tile::CellClass::kRoad || c == semantic_map::tile::CellClass::kCurb))
    return semantic_map::tile::CellClass::kUnknown;
  return c;
}

}  // namespace

std::vector<semantic_map::tile::VotedTile> vote_tiles(std::span<const Eigen::Vector3f> points,
                                                      const CloudMapOptions& options, CloudMap& counts,
                                                      std::span<const std::uint8_t> intensities) {
  const UsablePoints usable = usable_points(points, options, counts);
  const std::vector<Eigen::Vector3d>& used = usable.positions;
  const tensor_voting::voting::CloudVotes votes =
      tensor_voting::voting::vote_cloud(used, options.voting, options.threads);
  std::map<TileKey, semantic_map::tile::VotedTile> tiles;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Eigen::Vector3d& p = used[i];
    const TileKey key = *tile_at(p.x(), p.y());
    semantic_map::tile::VotedTile& tile = tiles[key];
    if (tile.points.empty()) {
      tile.key = key;
      tile.revision = 1;
      tile.z_origin = static_cast<float>(std::floor(p.z()));
    }
    const tensor_voting::kernels::DecompositionF& d = votes.decompositions[i];
    tile.points.push_back({{d.normal, d.stick, d.plate, d.mass},
                           static_cast<float>(p.x() - key.x * kTileSize),
                           static_cast<float>(p.y() - key.y * kTileSize),
                           static_cast<float>(p.z())});
    if (intensities.size() == points.size()) tile.intensity.push_back(intensities[usable.indices[i]]);
  }
  std::vector<semantic_map::tile::VotedTile> result;
  result.reserve(tiles.size());
  for (auto& [key, tile] : tiles) result.push_back(std::move(tile));
  return result;
}

void map_tiles(const std::vector<semantic_map::tile::VotedTile>& tiles, const CloudMapOptions& options, CloudMap& map) {
  semantic_map::pipeline::TilePipeline pipeline(options.curb, options.classes, options.markings);
  for (const semantic_map::tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  for (const semantic_map::tile::VotedTile& tile : tiles) {
    map.tiles.push_back(*pipeline.classes(tile.key));
    const semantic_map::tile::MapTile& computed = map.tiles.back();
    const Eigen::Vector2d corner(tile.key.x * kTileSize, tile.key.y * kTileSize);
    for (const semantic_map::curbs::CurbPoint& c : *pipeline.curbs(tile.key)) {
      const Eigen::Vector2d foot = c.foot + corner;
      map.curbs.push_back({{foot.x(), foot.y(), c.z}, c.height, c.up});
    }
    for (const semantic_map::tile::VotedPoint& p : tile.points) {
      map.points.push_back(
          {{static_cast<float>(corner.x() + double{p.x}), static_cast<float>(corner.y() + double{p.y}), p.z},
           p.normal,
           p.stick,
           p.plate,
           p.mass > 0 ? 1 - p.stick - p.plate : 0,
           label_of(p, computed, options.classes)});
    }
  }
  map.lines = semantic_map::all_curbs(pipeline);
  map.markings = semantic_map::all_markings(pipeline, map.lines, options.path, options.markings);
}

CloudMap map_cloud(std::span<const Eigen::Vector3f> points, const CloudMapOptions& options) {
  CloudMap map;
  const std::vector<semantic_map::tile::VotedTile> tiles = vote_tiles(points, options, map);
  map_tiles(tiles, options, map);
  return map;
}

}  // namespace curbstone::detect::cloud_map
