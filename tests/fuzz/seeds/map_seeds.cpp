// Maps on disk: a journal, the folder of a dense map, changes of a map of semantic_map.
#include <array>
#include <filesystem>
#include <string>

#include "services/mapper/journal/journal_codec.hpp"
#include "services/mapper/journal/local_map_file.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "tests/fuzz/seeds/seed_folder.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::fuzz {
namespace {

mapper::scan::Keyframe keyframe(std::int64_t utime) {
  mapper::scan::Keyframe node;
  node.utime = utime;
  node.points = std::vector<mapper::scan::KeyframePoint>{{100, 200, 300}, {-100, 200, 300}};
  return node;
}

mapper::pose_graph::PoseEdge edge() {
  mapper::pose_graph::PoseEdge edge;
  edge.to = 1;
  edge.information.setIdentity();
  return edge;
}

mapper::dense_map::TileRecords records() {
  return {{{1, 2, 3, 40}, {100, 2, 3, 50}}, {{0, 0, 1'000'000}}};
}

/// Two batches: a drive of two nodes, and what came then.
Seed journal() {
  namespace journal = mapper::journal;
  std::string begin;
  journal::append_head(begin, "", 7, 0);
  journal::append_node(begin, keyframe(1'000'000), 0);
  journal::append_node(begin, keyframe(2'000'000), 1);
  journal::append_edge(begin, edge());
  journal::append_tile(begin, {0, 0}, 0, records(), 0, 0);
  journal::append_tile(begin, {0, 1}, 0, records(), 0, 0);
  journal::append_pose(begin, {1'000'000, 1, 0, Pose::Identity(), Pose::Identity(), true, 1'000'000, true});
  std::string more;
  mapper::dense_map::TileRecords grown = records();
  grown.records.push_back({7, 8, 9, 10});
  journal::append_tile(more, {0, 0}, 0, grown, 2, 1);
  journal::append_eviction(more, {0, 1});
  journal::append_rings(more, {3, std::vector<mapper::intensity::RingHistograms::Counts>(1)});
  journal::append_pose(more, {2'000'000, 2, 1, Pose::Identity(), Pose::Identity(), true, 1'000'000, true});
  Seed seed;
  put_piece(seed, bytes_of(begin));
  put_piece(seed, bytes_of(more));
  return seed;
}

/// Two batches: a part of a local map, and the rest.
Seed local_map() {
  using mapper::registration::VoxelSums;
  const VoxelSums voxel{{1, -2, 3}, {1, 0.1F, 0.1F, 0.1F}}, other{{4, 5, 6}, {2, 0.1F, 0.1F, 0.1F}};
  Seed seed;
  for (const std::int64_t utime : {0, 1'000'000})
    put_piece(seed, bytes_of(mapper::journal::encoded({"", 0, utime, {{voxel, other}, {voxel}}})));
  return seed;
}

/// The files in the order of the target.
Seed map_folder() {
  mapper::storage::SavedMap map;
  mapper::storage::SavedTile tile;
  tile.utime = 2'000'000;
  tile.points = {{1, 2, 3, 40}, {100, 2, 3, 50}};
  map.tiles.push_back(tile);
  map.nodes = {keyframe(1'000'000), keyframe(2'000'000)};
  map.edges = {edge()};
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "map";
  (void)mapper::storage::save_map(map, path);
  Seed seed;
  for (const char* name : {"map.yaml", "tiles.csv", "nodes.csv", "graph.csv", "rings.csv", "tiles/0_0.pcd",
                           "tiles/-1_2.pcd", "nodes/000000.pcd", "nodes/000001.pcd"})
    put_piece(seed, SeedFolder::read(path / name));
  return seed;
}

/// Sets a column to a number, and another to some bytes.
Seed values() {
  Seed seed = {0, 0, 0};
  put(seed, std::int64_t{5});
  put(seed, std::uint8_t{8});
  put(seed, std::uint8_t{2});
  put_piece(seed, std::array<std::uint8_t, 24>{});
  return seed;
}

Seed bytes() {
  Seed seed = {1};
  put(seed, std::uint32_t{4096});
  put_piece(seed, bytes_of("abc"));
  return seed;
}

}  // namespace

void write_map_seeds(const SeedFolder& folder) {
  folder.write("journal", "drive", journal());
  folder.write("journal", "local_map", local_map());
  folder.write("map_folder", "map", map_folder());
  folder.write("map_file", "values", values());
  folder.write("map_file", "bytes", bytes());
}

}  // namespace curbstone::fuzz
