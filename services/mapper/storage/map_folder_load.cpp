#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/mapper/storage/map_file.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_folder_rules.hpp"
#include "services/mapper/storage/pcd_file.hpp"

namespace curbstone::mapper::storage {

namespace fs = std::filesystem;

namespace {

using Rules = MapFolderRules;

constexpr std::size_t kMaxYaml = 65536;  // bytes

struct MapHead {
  SavedMap map;
  std::size_t tiles = 0;
  std::size_t nodes = 0;
  std::size_t edges = 0;
  std::size_t rings = 0;
};

template <class Value>
Value value_of(const YAML::Node& yaml, const char* key, const fs::path& file) {
  const YAML::Node node = yaml[key];
  if (!node) fail_map(file, fmt::format("{} is missing", key));
  try {
    return node.as<Value>();
  } catch (const YAML::Exception&) {
    fail_map(file, fmt::format("{}: expected a number", key));
  }
}

MapHead read_head(const fs::path& folder) {
  const fs::path file = folder / "map.yaml";
  YAML::Node yaml;
  try {
    yaml = YAML::Load(read_map_file(file, kMaxYaml));
  } catch (const YAML::Exception& error) {
    fail_map(file, error.what());
  }
  if (!yaml.IsMap()) fail_map(file, "is not the head of a map");
  const int format = value_of<int>(yaml, "format", file);
  if (format > kMapFormat)
    fail_map(file, fmt::format("format {} is newer than {}, which this program knows", format, kMapFormat));
  if (format != kMapFormat) fail_map(file, fmt::format("format {}: expected {}", format, kMapFormat));
  for (const auto& [key, expected] : {std::pair{"tile_size", kTileSize}, {"position_step", kPositionStep}}) {
    const auto value = value_of<double>(yaml, key, file);
    if (value != expected) fail_map(file, fmt::format("{} {}: expected {}", key, value, expected));
  }
  const auto count = [&](const char* key, std::int64_t max) {
    const auto value = value_of<std::int64_t>(yaml, key, file);
    if (value < 0 || value > max) fail_map(file, fmt::format("{} {}: expected 0 to {}", key, value, max));
    return static_cast<std::size_t>(value);
  };
  MapHead head;
  head.map.voxel = value_of<double>(yaml, "voxel", file);
  head.map.epoch = value_of<std::int32_t>(yaml, "epoch", file);
  head.tiles = count("tiles", Rules::kMaxTiles);
  head.nodes = count("nodes", Rules::kMaxNodes);
  head.edges = count("edges", Rules::kMaxEdges);
  if (yaml["rings"]) {  // otherwise it is of a version without rings
    head.rings = count("rings", intensity::RingHistograms::kMaxRings);
    head.map.rings.scans = static_cast<std::int32_t>(count("ring_scans", Rules::kMaxRingScans));
  }
  return head;
}

MapRow row_at(const std::vector<std::string>& rows, std::size_t i, const fs::path& file) {
  return {rows[i], fmt::format("{}:{}", file.string(), i + 2)};
}

Pose read_pose(MapRow& row) {
  Pose pose = Pose::Identity();
  for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = row.number();
  return pose;
}

/// The steps from which pcd_coordinate() makes `value`. Clears `valid` if there are none between min and max.
std::int16_t steps_of(double corner, float value, int min, int max, bool& valid) {
  const double steps = std::round((static_cast<double>(value) - corner) / kPositionStep);
  const bool inside = steps >= min && steps <= max;
  const auto whole = static_cast<std::int16_t>(inside ? steps : 0.0);
  valid = valid && inside && pcd_coordinate(corner, whole) == value;
  return whole;
}

std::vector<TilePoint> read_tile_points(const SavedTile& tile, const fs::path& file) {
  const std::vector<float> values = read_pcd(file, Rules::kTileFields, Rules::kMaxTilePoints);
  std::vector<TilePoint> points(values.size() / 4);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float* v = &values[4 * i];
    bool valid = v[3] >= 0.0F && v[3] <= 255.0F && v[3] == std::round(v[3]);
    const std::int16_t x = steps_of(tile.key.x * kTileSize, v[0], 0, kStepsPerTile - 1, valid);
    const std::int16_t y = steps_of(tile.key.y * kTileSize, v[1], 0, kStepsPerTile - 1, valid);
    const std::int16_t z = steps_of(tile.z_origin, v[2], INT16_MIN, INT16_MAX, valid);
    if (!valid)
      fail_map(file, fmt::format("point {} ({} {} {}, intensity {}) is none of the 2 mm steps of its tile", i, v[0],
                                 v[1], v[2], v[3]));
    points[i] = {x, y, z, static_cast<std::uint8_t>(v[3])};
  }
  return points;
}

std::vector<scan::KeyframePoint> read_node_points(const fs::path& file) {
  const std::vector<float> values = read_pcd(file, Rules::kNodeFields, Rules::kMaxNodePoints);
  std::vector<scan::KeyframePoint> points(values.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool valid = true;
    const auto steps = [&](std::size_t axis) {
      return steps_of(0.0, values[3 * i + axis], INT16_MIN, INT16_MAX, valid);
    };
    points[i] = {steps(0), steps(1), steps(2)};
    if (!valid) fail_map(file, fmt::format("point {} is none of the 2 mm steps within 65 m", i));
  }
  return points;
}

void read_tiles(const MapHead& head, int voxel_steps, const fs::path& folder, const MapVisitor& visitor) {
  const fs::path table = folder / "tiles.csv";
  const std::vector<std::string> rows = read_map_rows(table, Rules::kTilesHeader, head.tiles);
  std::set<TileKey> seen;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MapRow row = row_at(rows, i, table);
    SavedTile tile;
    tile.key.x = static_cast<std::int32_t>(row.integer(-Rules::kMaxTileKey, Rules::kMaxTileKey));
    tile.key.y = static_cast<std::int32_t>(row.integer(-Rules::kMaxTileKey, Rules::kMaxTileKey));
    tile.z_origin = static_cast<std::int32_t>(row.integer(-Rules::kMaxZOrigin, Rules::kMaxZOrigin));
    tile.utime = row.integer(0, Rules::kMaxUtime);
    row.end();
    if (!seen.insert(tile.key).second) row.fail("is there twice");
    const fs::path file = folder / map_tile_file(tile.key);
    tile.points = read_tile_points(tile, file);
    check_map_tile(tile, voxel_steps, file);
    visitor.tile(std::move(tile));
  }
}

void read_nodes(const MapHead& head, const fs::path& folder, const MapVisitor& visitor) {
  const fs::path table = folder / "nodes.csv";
  const std::vector<std::string> rows = read_map_rows(table, Rules::kNodesHeader, head.nodes);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MapRow row = row_at(rows, i, table);
    scan::Keyframe node;
    node.utime = row.integer(0, Rules::kMaxUtime);
    node.T_map_base = read_pose(row);
    row.end();
    node.points = read_node_points(folder / keyframe_file(i));
    check_keyframe(node, table, i);
    visitor.node(std::move(node));
  }
}

void read_graph(MapHead& head, const fs::path& folder) {
  const fs::path table = folder / "graph.csv";
  const std::vector<std::string> rows = read_map_rows(table, Rules::kGraphHeader, head.edges);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MapRow row = row_at(rows, i, table);
    pose_graph::PoseEdge edge;
    edge.from = static_cast<int>(row.integer(0, Rules::kMaxNodes));
    edge.to = static_cast<int>(row.integer(0, Rules::kMaxNodes));
    edge.closes_loop = row.integer(0, 1) == 1;
    edge.T_from_to = read_pose(row);
    for (int k = 0; k < 36; ++k) edge.information(k / 6, k % 6) = row.number();
    row.end();
    check_map_edge(edge, head.nodes, table, i);
    head.map.edges.push_back(edge);
  }
}

void read_rings(MapHead& head, const fs::path& folder) {
  if (head.rings == 0) return;
  const fs::path table = folder / "rings.csv";
  const std::vector<std::string> rows = read_map_rows(table, Rules::kRingsHeader, head.rings);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MapRow row = row_at(rows, i, table);
    intensity::RingHistograms::Counts counts{};
    for (std::uint32_t& count : counts)
      count = static_cast<std::uint32_t>(row.integer(0, intensity::RingHistograms::kMaxReturns));
    row.end();
    head.map.rings.rings.push_back(counts);
  }
}

}  // namespace

SavedMap load_map(const fs::path& folder) {
  std::vector<SavedTile> tiles;
  std::vector<scan::Keyframe> nodes;
  SavedMap map = load_map(folder, {[&](SavedTile tile) { tiles.push_back(std::move(tile)); },
                                   [&](scan::Keyframe node) { nodes.push_back(std::move(node)); }});
  map.tiles = std::move(tiles);
  map.nodes = std::move(nodes);
  return map;
}

SavedMap load_map(const fs::path& folder, const MapVisitor& visitor) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) fail_map(folder, "no such folder");
  MapHead head = read_head(folder);
  const int voxel_steps = check_map_head(head.map, folder / "map.yaml");
  read_tiles(head, voxel_steps, folder, visitor);
  read_nodes(head, folder, visitor);
  read_graph(head, folder);
  read_rings(head, folder);
  return std::move(head.map);
}

}  // namespace curbstone::mapper::storage
