#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <random>

#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_folder_rules.hpp"
#include "tests/services/mapper/storage/saved_map_fixture.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::storage {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BadMapFolder : public ::testing::Test {
 protected:
  BadMapFolder() : map_(random_map(5, 2, 3)), folder_(scratch_ / "town") {
    save_map(map_, folder_);
    files_ = {folder_ / "map.yaml",
              folder_ / "tiles.csv",
              folder_ / "nodes.csv",
              folder_ / "graph.csv",
              folder_ / map_tile_file(map_.tiles[0].key),
              folder_ / keyframe_file(1),
              folder_ / "rings.csv"};
  }

  /// What loading says; empty if it loads.
  std::string complaint() const {
    try {
      (void)load_map(folder_);
      return "";
    } catch (const MapFolderError& error) {
      return error.what();
    }
  }

  std::string complaint_with(const fs::path& file, const std::string& from, const std::string& to) const {
    const std::string good = bytes_of(file);
    std::string bytes = good;
    EXPECT_NE(bytes.find(from), std::string::npos) << from;
    put_bytes(file, bytes.replace(bytes.find(from), from.size(), to));
    std::string said = complaint();
    put_bytes(file, good);
    return said;
  }

  std::string complaint_with_value(const fs::path& file, std::size_t index, float value) const {
    const std::string good = bytes_of(file);
    std::string bytes = good;
    std::memcpy(&bytes[bytes.find("DATA binary\n") + 12 + index * sizeof value], &value, sizeof value);
    put_bytes(file, bytes);
    std::string said = complaint();
    put_bytes(file, good);
    return said;
  }

  test::TemporaryFolder scratch_ = test::TemporaryFolder::in_memory();
  SavedMap map_;
  fs::path folder_;
  std::vector<fs::path> files_;
};

TEST_F(BadMapFolder, EveryMissingFileIsNamed) {
  for (const fs::path& file : files_) {
    const std::string good = bytes_of(file);
    fs::remove(file);
    EXPECT_EQ(complaint(), file.string() + ": is missing");
    fs::create_directory(file);
    EXPECT_EQ(complaint(), file.string() + ": is not a file");
    fs::remove(file);
    put_bytes(file, good);
  }
  EXPECT_EQ(complaint(), "");
  EXPECT_THROW((void)load_map(scratch_ / "nowhere"), MapFolderError);
}

TEST_F(BadMapFolder, EveryTruncationIsRefused) {
  for (const fs::path& file : files_) {
    const std::string good = bytes_of(file);
    for (std::size_t size = 0; size + 1 < good.size(); ++size) {
      put_bytes(file, good.substr(0, size));
      EXPECT_THAT(complaint(), HasSubstr(folder_.string())) << file << " cut to " << size;
    }
    put_bytes(file, good);
  }
}

TEST_F(BadMapFolder, FlippedBitsAndRandomBytesAreRefusedOrMakeAnotherMap) {
  std::mt19937 random(7);
  for (const fs::path& file : files_) {
    const std::string good = bytes_of(file);
    int refused = 0;
    for (int i = 0; i < 1500; ++i) {
      std::string bytes = good;
      for (unsigned n = 0; n <= random() % 4; ++n) {
        const std::size_t at = random() % bytes.size();
        switch (random() % 4) {
          case 0:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
            break;
          case 1:
            bytes[at] = static_cast<char>(random());
            break;
          case 2:
            bytes[at] = "0123456789-,.e\n "[random() % 16];
            break;
          default:
            bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 40));
        }
      }
      put_bytes(file, bytes);
      try {
        const SavedMap other = load_map(folder_);
        save_map(other, scratch_ / "other");  // what loads is a map in every respect
      } catch (const MapFolderError& error) {
        EXPECT_THAT(error.what(), HasSubstr(folder_.string()));
        ++refused;
      }
    }
    EXPECT_GT(refused, 300) << file;
    put_bytes(file, good);
  }
  EXPECT_TRUE(equal(load_map(folder_), map_));
}

TEST_F(BadMapFolder, ANewerFormatIsSaid) {
  EXPECT_THAT(complaint_with(files_[0], "format: 1", "format: 2"), HasSubstr("format 2 is newer than 1"));
  EXPECT_THAT(complaint_with(files_[0], "format: 1", "format: 0"), HasSubstr("format 0"));
  EXPECT_THAT(complaint_with(files_[0], "format: 1", "image: map.pgm"), HasSubstr("format is missing"));
  EXPECT_THAT(complaint_with(files_[0], "tile_size: 3", "tile_size: 4"), HasSubstr("tile_size 4: expected 3"));
}

TEST_F(BadMapFolder, ClaimsWithoutEndAreRefusedBeforeMemoryIsTaken) {
  EXPECT_THAT(complaint_with(files_[0], "tiles: 2", "tiles: 20000000000"), HasSubstr("expected 0 to"));
  EXPECT_THAT(complaint_with(files_[0], "tiles: 2", "tiles: 10000000"), HasSubstr("2 rows; map.yaml has 10000000"));
  EXPECT_THAT(complaint_with(files_[0], "nodes: 3", "nodes: -1"), HasSubstr("nodes -1"));
  EXPECT_THAT(complaint_with(files_[0], "rings: 3", "rings: 257"), HasSubstr("rings 257"));
  EXPECT_THAT(complaint_with(files_[0], "rings: 3", "rings: 4"), HasSubstr("3 rows; map.yaml has 4"));
  EXPECT_THAT(complaint_with(files_[0], "voxel: 0.05", "voxel: 0.0001"), HasSubstr("voxel 0.0001"));
  const std::string points = "POINTS " + std::to_string(map_.tiles[0].points.size());
  EXPECT_THAT(complaint_with(files_[4], points, "POINTS 4000000000"), HasSubstr("truncated?"));
  EXPECT_THAT(complaint_with(files_[4], points, "POINTS 99999999999999999999"), HasSubstr("truncated?"));
  fs::resize_file(files_[4], std::uintmax_t{1} << 40);  // sparse: a terabyte of nothing
  EXPECT_THAT(complaint(), HasSubstr("1099511627776 bytes"));
  put_bytes(files_[0], std::string(1 << 16, '['));
  EXPECT_THAT(complaint(), HasSubstr("map.yaml"));
}

TEST_F(BadMapFolder, PointsThatAreNoneAreNamed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float value : {nan, std::numeric_limits<float>::infinity(), -1e30F, 1e30F}) {
    EXPECT_THAT(complaint_with_value(files_[4], 4 * 3 + 1, value), HasSubstr("point 3"));
    EXPECT_THAT(complaint_with_value(files_[5], 3 * 3 + 2, value), HasSubstr("point 3"));
  }
  EXPECT_THAT(complaint_with_value(files_[4], 3, 256.0F), HasSubstr("intensity 256"));
  EXPECT_THAT(complaint_with_value(files_[4], 3, 7.5F), HasSubstr("intensity 7.5"));
  const auto outside = static_cast<float>(map_.tiles[0].key.x * kTileSize - 0.002);
  EXPECT_THAT(complaint_with_value(files_[4], 0, outside), HasSubstr("point 0"));
  const auto between = static_cast<float>(map_.tiles[0].key.x * kTileSize + 0.101);
  EXPECT_THAT(complaint_with_value(files_[4], 0, between), HasSubstr("2 mm steps"));
}

TEST_F(BadMapFolder, TwoPointsInAVoxelAreRefused) {
  std::string bytes = bytes_of(files_[4]);
  const std::size_t data = bytes.find("DATA binary\n") + 12;
  put_bytes(files_[4], bytes.replace(data, 16, bytes.substr(data + 32, 16)));
  EXPECT_THAT(complaint(), HasSubstr("point 2 is in another's voxel"));
}

TEST_F(BadMapFolder, RowsAreCheckedAndNamed) {
  put_bytes(files_[1], "x,y,z_origin,utime\n1,1,0,5\n1,1,0,5\n");
  put_bytes(folder_ / "tiles/1_1.pcd", bytes_of(files_[4]));
  EXPECT_THAT(complaint(), HasSubstr("tiles/1_1.pcd: point 0"));
  put_bytes(files_[1], "x,y,z_origin,utime\n1,99999,0,5\n1,1,0,5\n");
  EXPECT_THAT(complaint(), HasSubstr("tiles.csv:2: 99999: expected"));
  put_bytes(files_[1], "x,y,z_origin,utime\n1,1,0\n1,1,0,5\n");
  EXPECT_THAT(complaint(), HasSubstr("tiles.csv:2: \"\": expected a whole number"));
  put_bytes(files_[1], "x,y,z_origin,utime\n1,1,0,5,6\n1,1,0,5\n");
  EXPECT_THAT(complaint(), HasSubstr("tiles.csv:2: has too many columns"));
}

}  // namespace
}  // namespace curbstone::mapper::storage
