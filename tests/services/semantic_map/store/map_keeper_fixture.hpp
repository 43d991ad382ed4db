#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "services/semantic_map/store/map_keeper.hpp"
#include "tests/stamps.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::semantic_map::store {

namespace fs = std::filesystem;

using test::kSecond;

inline tile::MapTile a_tile(std::int32_t x, tile::CellClass cell_class = tile::CellClass::kRoad, unsigned noise = 0) {
  tile::MapTile tile;
  tile.key = {x, 0};
  tile.utime = kSecond + noise;
  tile.cell_class.fill(cell_class);
  for (std::size_t i = 0; i < tile::kCellsInTile; ++i)
    tile.cost[i] = static_cast<std::uint8_t>(noise * (i * i + 7 * i));
  return tile;
}

inline tile::TrajectoryPose a_pose(std::int64_t utime) {
  return {utime, static_cast<std::int32_t>(utime / 50'000), Pose::Identity()};
}

class MapKeeperTest : public ::testing::Test {
 protected:
  /// Until what was begun is written: the next write() has nothing to do.
  static void write_all(MapKeeper& keeper) {
    const auto done = [&] { return keeper.counters()["store.transactions"] + keeper.counters()["faults.store"]; };
    const std::int64_t before = done();
    keeper.write();
    for (int i = 0; i < 5000 && done() == before; ++i, usleep(1000)) keeper.write();
  }

  /// The maps beside map.db.
  [[nodiscard]] std::vector<fs::path> kept() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path_.parent_path()))
      if (entry.path() != path_) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
  }
  static void drive(MapKeeper& keeper, std::int32_t epoch, std::int64_t utime, int tiles) {
    keeper.start(epoch, utime);
    for (int x = 0; x < tiles; ++x) keeper.put(a_tile(x));
    keeper.put(a_pose(utime));
  }
  /// A service that is killed when `tiles` of a corrected drive have come again.
  void die_in_a_correction(int tiles) const {
    MapKeeper keeper(path_, 1000);
    drive(keeper, 7, kSecond, 200);
    drive(keeper, 8, 10 * kSecond, tiles);
    keeper.corrected_from(kSecond);
    write_all(keeper);
  }

  test::TemporaryFolder folder_;
  fs::path path_ = folder_ / "map.db";
};

}  // namespace curbstone::semantic_map::store
