#include "tools/export/dense_cloud.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <curbstone/map_points_t.hpp>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "common/log/log_reader.hpp"
#include "common/tiles/tile.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::map_export {

namespace {

struct TilePoints {
  double z_origin = 0;
  std::map<std::int32_t, std::vector<TilePoint>> pieces;  ///< by index of their first point
};

bool decode(const LogEvent& event, map_points_t& message) {
  try {
    if (message.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) < 0) return false;
  } catch (const std::exception&) {
    return false;  // lcm-gen 1.3.1 throws on a negative array length
  }
  return message.first >= 0 && message.num_points <= std::numeric_limits<std::int32_t>::max() - message.first &&
         std::isfinite(message.z_origin);
}

std::vector<TilePoint> points_of(const map_points_t& message) {
  std::vector<TilePoint> points;
  points.reserve(static_cast<std::size_t>(message.num_points));
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.num_points); ++i)
    points.push_back({message.x[i], message.y[i], message.z[i], message.intensity[i]});
  return points;
}

/// The points that remain after a tile's list of records; the removal of a missing point has no effect.
std::vector<TilePoint> standing_points(const TilePoints& tile, std::int64_t& missing) {
  const auto place = [](const TilePoint& p) { return std::array{p.x, p.y, p.z}; };
  std::vector<std::optional<TilePoint>> points;
  std::map<std::array<std::int16_t, 3>, std::size_t> at;
  std::int64_t next = 0;
  for (const auto& [first, piece] : tile.pieces) {
    if (first > next) {
      missing += first - next;
      next = first;
    }
    for (auto i = static_cast<std::size_t>(next - first); i < piece.size(); ++i) {
      if (!is_removal(piece[i])) {
        at[place(piece[i])] = points.size();
        points.emplace_back(piece[i]);
      } else if (const auto it = at.find(place(removal_of(piece[i]))); it != at.end()) {
        points[it->second].reset();
      }
    }
    next = std::max<std::int64_t>(next, first + static_cast<std::int64_t>(piece.size()));
  }
  std::vector<TilePoint> standing;
  for (const auto& point : points) {
    if (point) standing.push_back(*point);
  }
  return standing;
}

void append(TileKey key, const TilePoints& tile, DenseCloud& cloud) {
  for (const TilePoint& p : standing_points(tile, cloud.missing)) {
    const Eigen::Vector3d position(key.x * kTileSize + p.x * kPositionStep, key.y * kTileSize + p.y * kPositionStep,
                                   tile.z_origin + p.z * kPositionStep);
    cloud.points.push_back({position.cast<float>(), static_cast<float>(p.intensity)});
  }
}

}  // namespace

DenseCloud read_dense_cloud(const std::string& log, std::int32_t epoch) {
  output::WatchedLog reader(log, "export");
  DenseCloud cloud;
  std::map<TileKey, TilePoints> tiles;
  std::set<std::int32_t> other_epochs;
  map_points_t message;
  while (const auto event = reader.next()) {
    if (event->channel != "MAP_POINTS") continue;
    if (!decode(*event, message)) {
      ++cloud.refused;
    } else if (message.epoch != epoch) {
      other_epochs.insert(message.epoch);
    } else if (message.num_points > 0) {
      TilePoints& tile = tiles[{message.tile_x, message.tile_y}];
      tile.z_origin = double{message.z_origin};
      std::vector<TilePoint>& piece = tile.pieces[message.first];
      if (piece.size() < static_cast<std::size_t>(message.num_points)) piece = points_of(message);
    }
  }
  cloud.log_is_damaged = reader.damaged();
  for (const auto& [key, tile] : tiles) append(key, tile, cloud);
  if (!cloud.points.empty()) return cloud;
  if (other_epochs.empty())
    throw std::runtime_error(
        fmt::format("{}: holds no MAP_POINTS: make them with 'curbstone replay {} --record NEW.lcmlog'", log, log));
  throw std::runtime_error(fmt::format("{}: its MAP_POINTS are of epoch {}, the map's epoch is {}: another drive", log,
                                       *other_epochs.rbegin(), epoch));
}

}  // namespace curbstone::map_export
