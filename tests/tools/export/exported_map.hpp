#pragma once

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "services/semantic_map/store/map_store.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/export/export.hpp"

namespace curbstone::map_export {

/// A small map across the origin, written through the store, and the folder of its export.
class ExportedMap : public ::testing::Test {
 protected:
  static constexpr std::int32_t kEpoch = 3;

  void write_map(const std::vector<semantic_map::tile::MapTile>& tiles,
                 const std::vector<semantic_map::tile::CurbLine>& curbs,
                 const std::vector<semantic_map::tile::TrajectoryPose>& trajectory = {}) const {
    semantic_map::store::MapStore store(path("map.db"));
    store.write({.epoch = kEpoch, .tiles = tiles, .trajectory = trajectory, .curbs = &curbs});
    store.close_canonical();
  }
  /// All classes, heights with gaps, costs of all kinds: (-1, 0), (0, 0), and (1, -2) apart from them.
  static std::vector<semantic_map::tile::MapTile> varied_tiles() {
    std::vector<semantic_map::tile::MapTile> tiles;
    std::mt19937 random(7);
    for (const TileKey key : {TileKey{-1, 0}, TileKey{0, 0}, TileKey{1, -2}}) {
      semantic_map::tile::MapTile tile;
      tile.key = key;
      tile.z_origin = -2;
      for (std::size_t i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
        // Mostly road: there shall be a slope.
        tile.cell_class[i] =
            random() % 4 == 0 ? static_cast<semantic_map::tile::CellClass>(random() % semantic_map::tile::kNumClasses)
                              : semantic_map::tile::CellClass::kRoad;
        const bool unknown = tile.cell_class[i] == semantic_map::tile::CellClass::kUnknown;
        tile.height[i] =
            unknown ? semantic_map::tile::MapTile::kNoHeight : static_cast<std::int16_t>(900 + random() % 200);
        tile.cost[i] = unknown ? 255 : static_cast<std::uint8_t>(random() % 255);
        tile.confidence[i] = static_cast<std::uint8_t>(random());
        tile.hits[i] = static_cast<std::uint8_t>(random());
      }
      tile.cell_class[0] = tile.cell_class[semantic_map::tile::kCellsInTile - 1] =
          semantic_map::tile::CellClass::kWall;  // the corners are known
      tiles.push_back(tile);
    }
    return tiles;
  }
  /// The options after the map's name.
  int run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"export", path("map.db"), "--out", path("out")});
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    std::exception_ptr thrown;
    int status = -1;
    try {
      status = run_export(static_cast<int>(argv.size()), argv.data());
    } catch (...) {
      thrown = std::current_exception();
    }
    said_ = ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
    if (thrown) std::rethrow_exception(thrown);
    return status;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string out(const std::string& name) const { return (folder_ / "out" / name).string(); }

  static std::string text_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  test::TemporaryFolder folder_;
  mutable std::string said_;
};

/// Somebody else's eyes: GDAL's programs. A test that needs them skips, visibly, where they are not installed
/// (scripts/install-deps --tests).
inline bool has_gdal() {
  return std::system("command -v gdalinfo >/dev/null && command -v ogr2ogr >/dev/null") == 0;
}

inline std::string output_of(const std::string& command, const std::string& input = "") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "input";
  std::ofstream(file) << input;
  std::string output;
  std::FILE* pipe = popen((command + " < " + file).c_str(), "r");
  if (pipe == nullptr) return "popen failed";
  std::array<char, 65536> buffer{};
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), size);
  EXPECT_EQ(pclose(pipe), 0) << command << "\n" << output;
  return output;
}

/// Rows of numbers, separated by blanks.
inline std::vector<std::vector<double>> rows_of(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    rows.emplace_back();
    for (double value = 0; words >> value;) rows.back().push_back(value);
  }
  return rows;
}

/// x, y, value of every cell of a raster's band, as GDAL sees it.
inline std::vector<std::vector<double>> cells_of(const std::string& raster, int band = 1) {
  return rows_of(output_of("gdal_translate -q -of XYZ -b " + std::to_string(band) + " " + raster + " /vsistdout/"));
}

}  // namespace curbstone::map_export
