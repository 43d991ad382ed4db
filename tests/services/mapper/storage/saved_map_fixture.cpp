#include "tests/services/mapper/storage/saved_map_fixture.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>

namespace curbstone::mapper::storage {

namespace fs = std::filesystem;

namespace {

Pose random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Pose pose = Pose::Identity();
  pose.translation() = 500.0 * Eigen::Vector3d(any(random), any(random), 0.01 * any(random));
  pose.linear() = rotation_from_rpy(0.1 * any(random), 0.1 * any(random), 3.0 * any(random));
  return pose;
}

template <class Matrix>
bool same_bits(const Matrix& a, const Matrix& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

bool equal_points(const TilePoint& a, const TilePoint& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.intensity == b.intensity;
}

bool equal_tiles(const SavedTile& a, const SavedTile& b) {
  return a.key == b.key && a.z_origin == b.z_origin && a.utime == b.utime &&
         std::ranges::equal(a.points, b.points, equal_points);
}

bool equal_nodes(const scan::Keyframe& a, const scan::Keyframe& b) {
  return a.utime == b.utime && same_bits(a.T_map_base.matrix(), b.T_map_base.matrix()) && a.points == b.points;
}

bool equal_edges(const pose_graph::PoseEdge& a, const pose_graph::PoseEdge& b) {
  return a.from == b.from && a.to == b.to && a.closes_loop == b.closes_loop &&
         same_bits(a.T_from_to.matrix(), b.T_from_to.matrix()) && same_bits(a.information, b.information);
}

}  // namespace

SavedMap random_map(unsigned seed, int tiles, int nodes) {
  std::mt19937 random(seed);
  SavedMap map;
  map.epoch = static_cast<std::int32_t>(seed);
  std::set<TileKey> keys;
  while (static_cast<int>(map.tiles.size()) < tiles) {
    SavedTile tile;
    tile.key = {static_cast<int>(random() % 400) - 200, static_cast<int>(random() % 400) - 200};
    if (!keys.insert(tile.key).second) continue;
    tile.z_origin = static_cast<int>(random() % 21) - 10;
    tile.utime = 1'750'000'000'000'000 + static_cast<int>(random() % 1'000'000);
    std::set<std::array<int, 3>> voxels;  // of 25 steps
    for (int i = 0; i < 60; ++i) {
      const std::array<int, 3> v{static_cast<int>(random() % 60), static_cast<int>(random() % 60),
                                 static_cast<int>(random() % 2600) - 1300};
      if (!voxels.insert(v).second) continue;
      const auto at = [&](int cell) { return static_cast<std::int16_t>(25 * cell + static_cast<int>(random() % 25)); };
      tile.points.push_back({at(v[0]), at(v[1]), at(v[2]), static_cast<std::uint8_t>(random())});
    }
    map.tiles.push_back(std::move(tile));
  }
  for (int i = 0; i < nodes; ++i) {
    scan::Keyframe node;
    node.utime = 1'750'000'000'000'000 + 1'000'000 * i;
    node.T_map_base = random_pose(random);
    std::vector<scan::KeyframePoint> points;
    for (int k = 0; k < 40; ++k) {
      const auto any = [&] { return static_cast<std::int16_t>(random()); };
      points.push_back({any(), any(), any()});
    }
    node.points = std::move(points);
    map.nodes.push_back(std::move(node));
  }
  for (int i = 1; i < nodes; ++i) {
    pose_graph::PoseEdge edge{.from = i - 1, .to = i, .T_from_to = random_pose(random), .closes_loop = i % 3 == 0};
    registration::Matrix6 m;
    for (double& value : m.reshaped()) value = static_cast<double>(random()) * 1e-5;
    edge.information = m * m.transpose();
    map.edges.push_back(edge);
  }
  map.rings.scans = 640;
  for (int ring = 0; ring < std::min(nodes, 256); ++ring) {  // of a LiDAR of 256 rings at most
    map.rings.rings.emplace_back();
    for (std::uint32_t& count : map.rings.rings.back()) count = static_cast<std::uint32_t>(random() % 9000);
  }
  return map;
}

bool equal(const SavedMap& a, const SavedMap& b) {
  return a.voxel == b.voxel && a.epoch == b.epoch && std::ranges::equal(a.tiles, b.tiles, equal_tiles) &&
         std::ranges::equal(a.nodes, b.nodes, equal_nodes) && std::ranges::equal(a.edges, b.edges, equal_edges) &&
         a.rings == b.rings;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace curbstone::mapper::storage
