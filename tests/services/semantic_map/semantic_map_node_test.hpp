#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "services/semantic_map/semantic_map_node.hpp"
#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map {

namespace fs = std::filesystem;
inline constexpr std::int64_t kStart = 1'780'000'000'000'000;

/// Pages of VOTED_POINTS, as a worker sends them.
inline std::vector<voted_points_t> to_pages(const tile::VotedTile& tile, std::int32_t revision, std::int32_t per_page) {
  std::vector<voted_points_t> pages;
  const auto total = static_cast<std::int32_t>(tile.points.size());
  for (std::int32_t first = 0; first < total; first += per_page) {
    voted_points_t m;
    m.utime = kStart;
    m.epoch = 1;
    m.tile_x = tile.key.x;
    m.tile_y = tile.key.y;
    m.z_origin = tile.z_origin;
    m.chain = 7;
    m.base = 0;
    m.revision = revision;
    m.page = first / per_page;
    m.num_pages = (total + per_page - 1) / per_page;
    m.total = total;
    m.first = first;
    m.num_points = std::min(per_page, total - first);
    m.num_scales = 1;
    m.sigma = {0.3F};
    m.num_voters = m.num_tensors = m.num_points;
    for (std::int32_t i = first; i < first + m.num_points; ++i) {
      const tile::VotedPoint& p = tile.points[static_cast<std::size_t>(i)];
      const auto steps = [](float x) { return static_cast<std::int16_t>(std::clamp(x / 0.002F, 0.0F, 1499.0F)); };
      m.x.push_back(steps(p.x));
      m.y.push_back(steps(p.y));
      m.z.push_back(static_cast<std::int16_t>((p.z - tile.z_origin) / 0.002F));
      m.intensity.push_back(0);
      m.voter.push_back(i);
      m.scale.push_back(0);
      m.point.push_back(i);
      m.normal_x.push_back(static_cast<std::int16_t>(p.normal.x() * 32767));
      m.normal_y.push_back(static_cast<std::int16_t>(p.normal.y() * 32767));
      m.normal_z.push_back(static_cast<std::int16_t>(p.normal.z() * 32767));
      m.tangent_x.push_back(0);
      m.tangent_y.push_back(0);
      m.tangent_z.push_back(0);
      m.stick.push_back(static_cast<std::uint8_t>(p.stick * 255));
      m.plate.push_back(static_cast<std::uint8_t>(p.plate * 255));
      m.mass.push_back(p.mass);
    }
    pages.push_back(m);
  }
  return pages;
}

inline map_pose_t pose_at(std::int64_t utime, double x, std::int32_t epoch = 1) {
  map_pose_t m{};
  m.utime = utime;
  m.revolution = static_cast<std::int32_t>((utime - kStart) / 50'000);
  m.epoch = epoch;
  m.map_base_position[0] = x;
  m.map_base_orientation[0] = 1;
  return m;
}

/// A street of voted tiles, and a folder for the map.
class SemanticMapNodeTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("semantic_map_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static const std::vector<tile::VotedTile>& street() {
    static const std::vector<tile::VotedTile> tiles = [] {
      SyntheticCloud cloud;
      cloud.ground(-6, -6, 6, 6, 150, [](double, double y) { return y > 1 ? 0.12 : 0.0; });
      cloud.face(-6, 1, 6, 1, 0, 0.12, 150);
      detect::cloud_map::CloudMapOptions options;
      options.threads = 1;
      detect::cloud_map::CloudMap counts;
      return detect::cloud_map::vote_tiles(cloud.points, options, counts);
    }();
    return tiles;
  }
  /// A tile in the middle. (At the border noise makes some with a point or two.)
  static const tile::VotedTile& full_tile() {
    return *std::max_element(street().begin(), street().end(),
                             [](const auto& a, const auto& b) { return a.points.size() < b.points.size(); });
  }
  static std::vector<voted_points_t> all_pages() {
    std::vector<voted_points_t> pages;
    for (const tile::VotedTile& tile : street()) {
      for (auto& page : to_pages(tile, 2, 400)) pages.push_back(std::move(page));
    }
    return pages;
  }
  SemanticMapConfig config(const std::string& name) const {
    SemanticMapConfig c;
    c.map = name.empty() ? "" : (folder_ / name).string();
    return c;
  }
  static std::string bytes(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_;
};

}  // namespace curbstone::semantic_map
