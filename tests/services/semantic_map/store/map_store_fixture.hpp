#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "services/semantic_map/store/map_store.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::semantic_map::store {

/// A map file in a folder of its own.
class MapStoreTest : public ::testing::Test {
 protected:
  static tile::MapTile tile(std::int32_t x, std::int32_t y, unsigned seed = 1) {
    std::mt19937 random(seed + static_cast<unsigned>(x * 1000 + y));
    tile::MapTile t;
    t.key = {x, y};
    t.utime = 1'000'000 + seed;
    t.z_origin = -3;
    for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
      t.cell_class[i] = static_cast<tile::CellClass>(random() % tile::kNumClasses);
      t.height[i] = static_cast<std::int16_t>(random());
      t.cost[i] = static_cast<std::uint8_t>(random());
      t.confidence[i] = static_cast<std::uint8_t>(random());
      t.hits[i] = static_cast<std::uint8_t>(random());
    }
    return t;
  }
  static tile::TrajectoryPose pose(std::int64_t utime) {
    tile::TrajectoryPose p{utime, static_cast<std::int32_t>(utime / 50'000), Pose::Identity()};
    p.T_map_base.translation() = Eigen::Vector3d(1e-6 * static_cast<double>(utime), 2, -0.1);
    p.T_map_base.linear() = rotation_from_rpy(0.01, -0.02, 1.5);
    return p;
  }
  static std::string bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write_file(const std::filesystem::path& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
  }
  template <class Work>
  static std::string error_of(Work work) {
    try {
      work();
    } catch (const MapStoreError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "map.db";
};

}  // namespace curbstone::semantic_map::store
