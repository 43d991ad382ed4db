#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/dense_map/dense_tile.hpp"
#include "services/mapper/dense_map/sweep_image.hpp"

namespace curbstone::mapper::dense_map {

/// Finds points of the dense map that beams pass through: they are no longer there. Points clear of the ground are
/// tested, and low ones where what stood above them has gone; never ground, which is seen at a grazing angle.
///
/// A cell of 0.2 m is free once beams have passed through half of its points, through each often enough (kOften), and
/// no beam has ended in it or beside it since: what beams can miss or pass (a pole, a fence, leaves, the edge of a
/// wall) is hit again before that. Pure; one thread.
class FreeSpace {
 public:
  /// `ground_clearance`: m above the lowest point of its column, from where on a point stands clear of the ground.
  explicit FreeSpace(double ground_clearance);

  /// From where a scan is looked at.
  struct View {
    const SweepImage& image;
    Pose T_lidar_map;
    double reach;                                       ///< m from the lidar: what is farther is not judged
    const std::function<bool(std::int32_t)>& in_place;  ///< whether an anchor's points may be tested
  };
  /// Looks at a tile whose corner is at `corner` (m, map), and returns the records of points that are gone.
  [[nodiscard]] std::vector<std::uint32_t> look(DenseTile& tile, const Eigen::Vector3d& corner, const View& view);

 private:
  struct Cell {
    int points = 0;
    int free = 0;        // of them, passed through often enough
    bool there = false;  // something was met
  };
  struct Candidate {
    std::uint32_t record;
    std::uint32_t cell;
    bool through;
  };
  void gather(DenseTile& tile, const Eigen::Vector3d& corner, const View& view);
  [[nodiscard]] bool met_about(std::uint32_t cell) const;

  float ground_clearance_;
  std::vector<Cell> cells_;  // of the tile that is looked at; between tiles all are empty
  std::vector<Candidate> candidates_;
};

}  // namespace curbstone::mapper::dense_map
