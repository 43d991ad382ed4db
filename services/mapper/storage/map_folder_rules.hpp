#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

/// Names and limits of a map folder, and the validity checks of a map, shared by saving and loading. All functions
/// throw MapFolderError; `file` is named in its text.
struct MapFolderRules {
  static constexpr const char* kTileFields = "x y z intensity";
  static constexpr const char* kNodeFields = "x y z";
  static constexpr const char* kTilesHeader = "x,y,z_origin,utime";
  static constexpr const char* kNodesHeader = "utime,r11,r12,r13,x,r21,r22,r23,y,r31,r32,r33,z";
  static constexpr const char* kGraphHeader = "from,to,loop,T_from_to 3x4,information 6x6";
  static constexpr const char* kRingsHeader = "returns of the road by intensity, 0 to 255";

  // Limits beyond any vehicle's map: larger claims are refused.
  static constexpr std::int64_t kMaxTiles = 10'000'000;  // 90 km2
  static constexpr std::int64_t kMaxNodes = 1'000'000;
  static constexpr std::int64_t kMaxEdges = 10'000'000;
  static constexpr std::int64_t kMaxRingScans = 1'000'000;
  static constexpr std::size_t kMaxTilePoints = 4'000'000;  // 64 MB
  static constexpr std::size_t kMaxNodePoints = 500'000;
  static constexpr std::int32_t kMaxTileKey = 10'921;  // 32,766 m: up to there float32 resolves 2 mm
  static constexpr std::int32_t kMaxZOrigin = 32'700;  // m
  static constexpr std::int64_t kMaxUtime = std::int64_t{1} << 60;
};

[[nodiscard]] std::filesystem::path map_tile_file(TileKey key);
[[nodiscard]] std::filesystem::path keyframe_file(std::size_t index);

/// A coordinate as it is written to a PCD, from its steps.
[[nodiscard]] inline float pcd_coordinate(double corner, std::int16_t steps) {
  return static_cast<float>(corner + steps * kPositionStep);
}

[[noreturn]] void fail_map(const std::filesystem::path& file, const std::string& what);
/// Checks the map's head. Returns a voxel's side in kPositionStep.
[[nodiscard]] int check_map_head(const SavedMap& map, const std::filesystem::path& file);
void check_map_tile(const SavedTile& tile, int voxel_steps, const std::filesystem::path& file);
/// `index`: row of `file`, from 0.
void check_keyframe(const scan::Keyframe& node, const std::filesystem::path& file, std::size_t index);
void check_map_edge(const pose_graph::PoseEdge& edge, std::size_t nodes, const std::filesystem::path& file,
                    std::size_t index);

}  // namespace curbstone::mapper::storage
