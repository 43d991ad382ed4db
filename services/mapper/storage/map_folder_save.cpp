#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/mapper/storage/atomic_folder.hpp"
#include "services/mapper/storage/map_file.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_folder_rules.hpp"
#include "services/mapper/storage/pcd_file.hpp"

namespace curbstone::mapper::storage {

namespace fs = std::filesystem;

namespace {

using Rules = MapFolderRules;

template <class Matrix>
std::string row_of(const Matrix& m, int rows) {
  std::string text;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < m.cols(); ++c) fmt::format_to(std::back_inserter(text), ",{}", m(r, c));
  }
  return text;
}

/// Reuses a file of the old map in the new one.
void keep_file(const fs::path& name, const AtomicFolder& target) {
  std::error_code error;
  fs::create_hard_link(target.folder() / name, target.partial() / name, error);
  if (error)
    fs::copy_file(target.folder() / name, target.partial() / name, error);  // not every file system has hard links
  if (error) fail_map(target.folder() / name, error.message());
}

/// Nothing if the tile is spilled and cannot be read back.
std::optional<SavedTile> with_points(SavedTile tile) {
  if (tile.spilled.empty()) return tile;
  try {
    tile.points = tile.spilled.read().points();
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
  return tile;
}

void write_tiles(const SavedMap& map, int voxel_steps, const AtomicFolder& target, MissingParts& missing) {
  const fs::path& folder = target.partial();
  std::string table = std::string(Rules::kTilesHeader) + "\n";
  std::set<TileKey> seen;
  std::vector<float> values;
  for (const SavedTile& tile : map.tiles) {
    const fs::path file = folder / map_tile_file(tile.key);
    if (!seen.insert(tile.key).second) fail_map(file, "is there twice");
    const std::optional<SavedTile> here = tile.on_disk ? tile : with_points(tile);
    if (!here) (tile.earlier ? missing.earlier : missing.gone).push_back(tile.key);
    if (!here && !tile.earlier) continue;
    fmt::format_to(std::back_inserter(table), "{},{},{},{}\n", tile.key.x, tile.key.y, tile.z_origin,
                   here ? tile.utime : *tile.earlier);
    if (!here || tile.on_disk) {
      keep_file(map_tile_file(tile.key), target);
      continue;
    }
    check_map_tile(*here, voxel_steps, file);
    values.clear();
    for (const TilePoint& p : here->points) {
      values.insert(values.end(),
                    {pcd_coordinate(tile.key.x * kTileSize, p.x), pcd_coordinate(tile.key.y * kTileSize, p.y),
                     pcd_coordinate(tile.z_origin, p.z), static_cast<float>(p.intensity)});
    }
    write_pcd(file, Rules::kTileFields, values);
  }
  write_map_file(folder / "tiles.csv", table);
}

void write_nodes(const SavedMap& map, const AtomicFolder& target, MissingParts& missing) {
  const fs::path& folder = target.partial();
  const fs::path file = folder / "nodes.csv";
  std::string table = std::string(Rules::kNodesHeader) + "\n";
  std::vector<float> values;
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const scan::Keyframe& node = map.nodes[i];
    check_keyframe(node, file, i);
    fmt::format_to(std::back_inserter(table), "{}{}\n", node.utime, row_of(node.T_map_base.matrix(), 3));
    if (i < map.nodes_on_disk) {
      keep_file(keyframe_file(i), target);
      continue;
    }
    values.clear();
    const auto points = node.points.read();
    if (points->size() != node.points.size()) missing.keyframes.push_back(i);
    for (const scan::KeyframePoint& p : *points)
      values.insert(values.end(), {pcd_coordinate(0.0, p.x), pcd_coordinate(0.0, p.y), pcd_coordinate(0.0, p.z)});
    write_pcd(folder / keyframe_file(i), Rules::kNodeFields, values, node.T_map_base);
  }
  write_map_file(file, table);
}

void write_graph(const SavedMap& map, const fs::path& folder) {
  const fs::path file = folder / "graph.csv";
  std::string table = std::string(Rules::kGraphHeader) + "\n";
  for (std::size_t i = 0; i < map.edges.size(); ++i) {
    const pose_graph::PoseEdge& edge = map.edges[i];
    check_map_edge(edge, map.nodes.size(), file, i);
    fmt::format_to(std::back_inserter(table), "{},{},{}{}{}\n", edge.from, edge.to, edge.closes_loop ? 1 : 0,
                   row_of(edge.T_from_to.matrix(), 3), row_of(edge.information, 6));
  }
  write_map_file(file, table);
}

void write_rings(const SavedMap& map, const fs::path& folder) {
  std::string table = std::string(Rules::kRingsHeader) + "\n";
  for (const auto& counts : map.rings.rings) {
    for (std::size_t i = 0; i < counts.size(); ++i)
      fmt::format_to(std::back_inserter(table), "{}{}", counts[i], i + 1 < counts.size() ? "," : "\n");
  }
  write_map_file(folder / "rings.csv", table);
}

void write_head(const SavedMap& map, std::size_t num_tiles, const fs::path& folder) {
  write_map_file(
      folder / "map.yaml",
      fmt::format("# A map of curbstone's mapper: services/mapper/storage/map_folder.hpp says what lies here.\n"
                  "format: {}\ntile_size: {}  # m\nposition_step: {}  # m\nvoxel: {}  # m\nepoch: {}\n"
                  "rings: {}\nring_scans: {}\ntiles: {}\nnodes: {}\nedges: {}\n",
                  kMapFormat, kTileSize, kPositionStep, map.voxel, map.epoch, map.rings.rings.size(), map.rings.scans,
                  num_tiles, map.nodes.size(), map.edges.size()));
}

/// Whether the folder contains only what save_map() has made.
bool is_map_folder(const fs::path& folder) {
  const auto all = [](const fs::path& in, const auto& rule) {
    std::error_code error;
    fs::directory_iterator entry(in, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
      if (!rule(*entry)) return false;
    }
    return !error;  // also if there is no folder
  };
  return all(folder, [&](const fs::directory_entry& entry) {
    const std::string name = entry.path().filename().string();
    std::error_code ignored;
    if (name == "tiles" || name == "nodes") {
      return all(entry.path(), [&](const fs::directory_entry& file) {
        return file.is_regular_file(ignored) && file.path().extension() == ".pcd";
      });
    }
    return entry.is_regular_file(ignored) && (name == "map.yaml" || name == "tiles.csv" || name == "nodes.csv" ||
                                              name == "graph.csv" || name == "rings.csv");
  });
}

}  // namespace

MissingParts save_map(const SavedMap& map, const fs::path& folder) {
  const int voxel_steps = check_map_head(map, folder);
  AtomicFolder target(folder, is_map_folder);
  for (const char* name : {"tiles", "nodes"}) {
    std::error_code error;
    fs::create_directory(target.partial() / name, error);
    if (error) fail_map(target.partial() / name, error.message());
  }
  MissingParts missing;
  write_tiles(map, voxel_steps, target, missing);
  write_nodes(map, target, missing);
  write_graph(map, target.partial());
  write_rings(map, target.partial());
  write_head(map, map.tiles.size() - missing.gone.size(), target.partial());
  target.commit();
  return missing;
}

}  // namespace curbstone::mapper::storage
