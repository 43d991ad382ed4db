#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/dense_map/dense_tile.hpp"
#include "services/mapper/dense_map/range_image.hpp"

namespace curbstone::mapper::dense_map {

/// Finds points of the dense map that beams pass through: the object has left. Tested are points clear of the ground,
/// and low points where what stood above them is gone. Ground is never tested, for it is seen at a grazing angle.
///
/// A cell of 0.2 m is free once half of its points have been passed through often enough (kMinScansThrough scans each),
/// and no beam has ended in it or in a cell beside it since. Objects that beams can miss or pass (a pole, a fence,
/// leaves, the edge of a wall) are hit again before that. Pure; one thread.
class FreeSpace {
 public:
  /// `ground_clearance`: m above the lowest point of its column from which on a point is clear of the ground.
  explicit FreeSpace(double ground_clearance);

  /// The scan to test against, and its pose.
  struct View {
    const RangeImage& image;
    Pose T_lidar_map;
    double reach;                                       ///< m from the lidar: farther points are not tested
    const std::function<bool(std::int32_t)>& in_place;  ///< whether an anchor's points may be tested
  };
  /// Tests a tile whose corner is at `corner` (m, map), and returns the records of the points that are gone.
  [[nodiscard]] std::vector<std::uint32_t> find_removed(DenseTile& tile, const Eigen::Vector3d& corner,
                                                        const View& view);
  /// The same for a tile that only few beams reach, farther from the vehicle.
  [[nodiscard]] std::vector<std::uint32_t> find_left_behind(DenseTile& tile, const Eigen::Vector3d& corner,
                                                            const View& view);

 private:
  struct Cell {
    int points = 0;
    int free = 0;      // points that were passed through often enough
    bool hit = false;  // a beam ended here
  };
  struct Candidate {
    std::uint32_t record;
    std::uint32_t cell;
    bool through;
  };
  /// A point above its column's lowest one.
  struct Tall {
    std::uint32_t record;
    float above;  // m
  };
  void gather(DenseTile& tile, const Eigen::Vector3d& corner, const View& view);
  [[nodiscard]] bool hit_nearby(std::uint32_t cell) const;

  void list_tall(DenseTile& tile, const TileRecords& content, std::size_t begin, std::size_t end);

  float ground_clearance_;
  std::vector<Tall> tall_;   // scratch
  std::vector<Cell> cells_;  // of the current tile; all are empty between tiles
  std::vector<Candidate> candidates_;
};

}  // namespace curbstone::mapper::dense_map
