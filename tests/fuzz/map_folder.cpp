// The folder of a dense map, of any files.
#include <filesystem>
#include <fstream>
#include <string>

#include "services/mapper/storage/map_folder.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace {

namespace fs = std::filesystem;
using namespace curbstone;
using mapper::storage::SavedMap;

/// In memory: a disk would be waited for.
const fs::path& home() {
  static const fs::path path = "/dev/shm/fuzz_map_folder-" + std::to_string(getpid());
  return path;
}

bool is_same(const SavedMap& a, const SavedMap& b) {
  if (a.epoch != b.epoch || a.tiles.size() != b.tiles.size() || a.nodes.size() != b.nodes.size() ||
      a.edges.size() != b.edges.size())
    return false;
  for (std::size_t i = 0; i < a.tiles.size(); ++i)
    if (a.tiles[i].key != b.tiles[i].key || a.tiles[i].points.size() != b.tiles[i].points.size()) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    if (a.nodes[i].T_map_base.matrix() != b.nodes[i].T_map_base.matrix()) return false;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const fs::path folder = home() / "map", again = home() / "again";
  fs::remove_all(home());
  fs::create_directories(folder / "tiles");
  fs::create_directories(folder / "nodes");
  for (const char* name : {"map.yaml", "tiles.csv", "nodes.csv", "graph.csv", "rings.csv", "tiles/0_0.pcd",
                           "tiles/-1_2.pcd", "nodes/000000.pcd", "nodes/000001.pcd"}) {
    const fuzz::Bytes bytes = input.piece();
    std::ofstream(folder / name, std::ios::binary) << fuzz::text(bytes);
  }
  try {
    const SavedMap map = mapper::storage::load_map(folder);
    (void)mapper::storage::save_map(map, again);
    fuzz::require(is_same(map, mapper::storage::load_map(again)), "what was read reads the same once it is saved");
  } catch (const mapper::storage::MapFolderError&) {
    // No map, and said so.
  }
  fs::remove_all(home());
  return 0;
}
