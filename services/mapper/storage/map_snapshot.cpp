#include "services/mapper/storage/map_snapshot.hpp"

#include <algorithm>
#include <utility>

#include "services/mapper/dense_map/dense_tile.hpp"
#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::storage {

namespace {

/// Puts a snapshot together. Tiles and keyframes that the folder on the disk has already are kept there, not copied.
class SnapshotBuilder {
 public:
  explicit SnapshotBuilder(const MapVersions& on_disk, std::int32_t epoch)
      : on_disk_(on_disk), comparable_(on_disk.epoch == epoch) {
    out_.map.epoch = out_.versions.epoch = epoch;
  }

  void add_tile(const TileKey& key, const dense_map::DenseTile& tile) {
    const MapVersions::Tile version{tile.utime(), tile.removed_at(), tile.num_records(), tile.z_origin()};
    const MapVersions::Tile* known = known_tile(key);
    const bool kept = known != nullptr && *known == version;
    SavedTile saved{key, tile.z_origin(), tile.utime(), {}, kept};
    if (!kept && tile.is_spilled()) {
      saved.spilled = tile.packed();
      if (known != nullptr && known->z_origin == version.z_origin) saved.earlier = known->utime;
    } else if (!kept) {
      saved.points = tile.read()->points();
    }
    out_.map.tiles.push_back(std::move(saved));
    out_.versions.tiles.emplace(key, version);
  }

  /// A tile that the map no longer has is kept as it was saved.
  void add_evicted(const TileKey& key) {
    const MapVersions::Tile* known = known_tile(key);
    if (known == nullptr) return;
    out_.map.tiles.push_back({key, known->z_origin, known->utime, {}, true});
    out_.versions.tiles.emplace(key, *known);
  }

  /// Keyframes are added in the order of their ids. Those from the first one that has changed are written.
  void add_node(const scan::Keyframe& node) {
    const std::size_t index = out_.versions.nodes.size();
    out_.versions.nodes.push_back({node.utime, node.T_map_base.matrix(), node.points.size()});
    const bool kept = comparable_ && out_.map.nodes_on_disk == index && index < on_disk_.nodes.size() &&
                      on_disk_.nodes[index] == out_.versions.nodes.back();
    if (kept) ++out_.map.nodes_on_disk;
    out_.map.nodes.push_back(kept ? scan::Keyframe{node.utime, node.T_map_base, {}} : node);
  }

  MapSnapshot finish(double voxel, const std::vector<pose_graph::PoseEdge>& edges) {
    std::sort(out_.map.tiles.begin(), out_.map.tiles.end(),
              [](const SavedTile& a, const SavedTile& b) { return a.key < b.key; });
    out_.map.voxel = voxel;
    out_.map.edges = edges;
    out_.versions.edges = edges.size();
    return std::move(out_);
  }

 private:
  [[nodiscard]] const MapVersions::Tile* known_tile(const TileKey& key) const {
    const auto known = on_disk_.tiles.find(key);
    return comparable_ && known != on_disk_.tiles.end() ? &known->second : nullptr;
  }

  const MapVersions& on_disk_;
  bool comparable_;
  MapSnapshot out_;
};

}  // namespace

MapSnapshot take_snapshot(const dense_map::DenseMap& dense, const pose_graph::Atlas& atlas, double voxel,
                          std::int32_t epoch, const MapVersions& on_disk) {
  SnapshotBuilder snapshot(on_disk, epoch);
  for (const TileKey& key : dense.keys()) {
    const dense_map::DenseTile& tile = *dense.tile(key);
    if (tile.num_points() > 0) snapshot.add_tile(key, tile);
  }
  for (const TileKey& key : dense.evicted()) snapshot.add_evicted(key);
  for (int id = 0; id < atlas.size(); ++id) snapshot.add_node(atlas.node(id));
  return snapshot.finish(voxel, atlas.edges());
}

}  // namespace curbstone::mapper::storage
