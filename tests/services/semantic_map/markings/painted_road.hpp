#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "services/semantic_map/map_lines.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"

namespace curbstone::semantic_map {

inline constexpr double kRoad = 64;
inline constexpr double kPaint = 160;

/// A flat road from -15 to 15 m along x, -6 to 6 m across, 300 points/m^2, with noise of 12 of 255.
inline std::vector<tile::VotedTile> road(const std::function<double(double, double)>& intensity) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(-15, 15), across(-6, 6);
  std::normal_distribution<double> noise(0, 12), height(0, 0.005);
  std::map<TileKey, tile::VotedTile> tiles;
  for (int i = 0; i < 30 * 12 * 300; ++i) {
    const double x = along(random);
    const double y = across(random);
    const TileKey key = *tile_at(x, y);
    tile::VotedTile& tile = tiles[key];
    tile.key = key;
    tile.revision = 1;
    tile.points.push_back({{Eigen::Vector3f::UnitZ(), 0.9F, 0.05F, 5.0F},
                           static_cast<float>(x - key.x * kTileSize),
                           static_cast<float>(y - key.y * kTileSize),
                           static_cast<float>(height(random))});
    tile.intensity.push_back(static_cast<std::uint8_t>(std::clamp(intensity(x, y) + noise(random), 1.0, 255.0)));
  }
  std::vector<tile::VotedTile> result;
  for (auto& [key, tile] : tiles) result.push_back(std::move(tile));
  return result;
}

/// Driven along x, at y = -1.5 m.
inline std::vector<Eigen::Vector2d> path() {
  std::vector<Eigen::Vector2d> path;
  for (double x = -15; x <= 15; x += 0.5) path.emplace_back(x, -1.5);
  return path;
}

inline std::vector<tile::MarkingLine> lines_of(const std::vector<tile::VotedTile>& tiles) {
  pipeline::TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  return all_markings(pipeline, all_curbs(pipeline), path(), {});
}

inline double painted_length(const tile::MarkingLine& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    const auto &a = line.points[i - 1], &b = line.points[i];
    if (a.painted) length += std::hypot(double{b.x} - double{a.x}, double{b.y} - double{a.y});
  }
  return length;
}

}  // namespace curbstone::semantic_map
