#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::tile {

/// @file
/// The types of the semantic map, as stored and drawn. Frame: map, in m.

/// The paper's Table I; the values of semantic_tile_t.
enum class CellClass : std::uint8_t { kUnknown = 0, kRoad = 1, kCurb = 2, kObstacle = 3, kWall = 4 };
inline constexpr int kNumClasses = 5;
inline constexpr int kCellsInTile = kCellsPerTile * kCellsPerTile;

/// 25 x 25 cells of 0.12 m. Cell (column, row) is at index row * 25 + column; row 0 has the lowest y.
struct MapTile {
  static constexpr std::int16_t kNoHeight = -32768;

  TileKey key;
  std::int64_t utime = 0;        ///< us, of the newest map points that went in
  std::int64_t curbs_utime = 0;  ///< us, of the newest points that its curbs include; not in the store
  float z_origin = 0;            ///< m in map
  std::array<CellClass, kCellsInTile> cell_class{};
  std::array<std::int16_t, kCellsInTile> height{};  ///< ground, else lowest point; 2 mm steps from z_origin; kNoHeight
  std::array<std::uint8_t, kCellsInTile> cost{};    ///< 0 free .. 254 lethal, 255 unknown
  std::array<std::uint8_t, kCellsInTile> confidence{};  ///< 0 .. 255; 0: interpolated, or unknown
  std::array<std::uint8_t, kCellsInTile> hits{};        ///< points of the dense map in the cell; 255: or more

  /// Whether the cell is road though nothing was seen in it: ground was seen on both sides, or the vehicle drove there.
  [[nodiscard]] bool is_interpolated(std::size_t cell) const {
    return cell_class[cell] == CellClass::kRoad && confidence[cell] == 0;
  }
  bool operator==(const MapTile&) const = default;
};

/// A point of a curb line.
struct CurbVertex {
  float x = 0, y = 0, z = 0;               ///< m in map, the foot of the curb
  float height = 0;                        ///< m, of the step, positive
  float high_side_x = 0, high_side_y = 0;  ///< unit vector towards the higher side
  bool operator==(const CurbVertex&) const = default;
};

/// One curb along its foot.
struct CurbLine {
  std::int32_t id = 0;
  float confidence = 0;  ///< 0..1
  bool dropped = false;  ///< a lowered kerb, as at a driveway
  std::vector<CurbVertex> points;
  bool inferred = false;  ///< not seen: a bridge between two measured lines, as behind a parked vehicle
  bool operator==(const CurbLine&) const = default;
};

/// Type of a road marking, as far as its geometry shows it. The values of marking_line_t.
enum class MarkingType : std::uint8_t {
  kUnknown = 0,
  kSolid = 1,
  kDashed = 2,
  kStopLine = 3,
  kCrossing = 4,
  kOther = 5
};
inline constexpr int kNumMarkingTypes = 6;

struct MarkingVertex {
  float x = 0, y = 0, z = 0;  ///< m in map, on the road, the middle of the paint
  bool painted = false;       ///< from here to the next vertex
  bool operator==(const MarkingVertex&) const = default;
};

/// A marking along its centre. A crossing runs through the centres of its bars, across them: `width` is their length,
/// `dash` their width.
struct MarkingLine {
  std::int32_t id = 0;
  MarkingType type = MarkingType::kUnknown;
  float confidence = 0;  ///< 0..1
  float width = 0;       ///< m, of the paint; 0: not known
  float dash = 0;        ///< m, median length of a painted piece; 0: not interrupted
  float gap = 0;         ///< m, median between two of them
  std::vector<MarkingVertex> points;
  bool operator==(const MarkingLine&) const = default;
};

/// All lines of a map.
struct MapLines {
  std::vector<CurbLine> curbs;
  std::vector<MarkingLine> markings;
};

/// Pose of the vehicle at the end of a revolution.
struct TrajectoryPose {
  std::int64_t utime = 0;       ///< us
  std::int32_t revolution = 0;  ///< of the LiDAR, as in MAP_POSE
  Pose T_map_base = Pose::Identity();
};

}  // namespace curbstone::semantic_map::tile
