#include "services/mapper/storage/map_snapshot.hpp"

#include <algorithm>
#include <utility>

#include "services/mapper/dense_map/dense_tile.hpp"
#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::storage {

MapSnapshot take_snapshot(const dense_map::DenseMap& dense, const pose_graph::Atlas& atlas, double voxel,
                          std::int32_t epoch, const MapVersions& on_disk) {
  MapSnapshot out;
  out.map.voxel = voxel;
  out.map.epoch = out.versions.epoch = epoch;
  const bool comparable = on_disk.epoch == epoch;
  for (const TileKey& key : dense.keys()) {
    const dense_map::DenseTile& tile = *dense.tile(key);
    if (tile.num_points() == 0) continue;
    const MapVersions::Tile version{tile.utime(), tile.removed_at(), tile.num_records(), tile.z_origin()};
    const auto known = on_disk.tiles.find(key);
    const bool is_known = comparable && known != on_disk.tiles.end();
    const bool kept = is_known && known->second == version;
    SavedTile saved{key, tile.z_origin(), tile.utime(), {}, kept};
    if (!kept && tile.is_spilled()) {
      saved.spilled = tile.packed();
      if (is_known && known->second.z_origin == version.z_origin) saved.earlier = known->second.utime;
    } else if (!kept) {
      saved.points = tile.read()->points();
    }
    out.map.tiles.push_back(std::move(saved));
    out.versions.tiles.emplace(key, version);
  }
  for (const TileKey& key : dense.evicted()) {  // stored as it was published
    const auto known = on_disk.tiles.find(key);
    if (!comparable || known == on_disk.tiles.end()) continue;
    out.map.tiles.push_back({key, known->second.z_origin, known->second.utime, {}, true});
    out.versions.tiles.insert(*known);
  }
  std::sort(out.map.tiles.begin(), out.map.tiles.end(),
            [](const SavedTile& a, const SavedTile& b) { return a.key < b.key; });
  for (int id = 0; id < atlas.size(); ++id) {
    const scan::Keyframe& node = atlas.node(id);
    const auto index = static_cast<std::size_t>(id);
    out.versions.nodes.push_back({node.utime, node.T_map_base.matrix(), node.points.size()});
    const bool kept = comparable && out.map.nodes_on_disk == index && index < on_disk.nodes.size() &&
                      on_disk.nodes[index] == out.versions.nodes.back();
    if (kept) ++out.map.nodes_on_disk;
    out.map.nodes.push_back(kept ? scan::Keyframe{node.utime, node.T_map_base, {}} : node);
  }
  out.map.edges = atlas.edges();
  out.versions.edges = out.map.edges.size();
  return out;
}

}  // namespace curbstone::mapper::storage
