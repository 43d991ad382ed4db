#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace curbstone::mapper::place_recognition {

/// How likely a place of the plane is to return a ray that meets something upright: 255 where the map has such a thing,
/// falling off about it. Level k holds the largest value of the 2^k x 2^k cells from its cell on, which bounds what any
/// shift by so much can score (Olson, ICRA 2009; Hess, Kohler, Rapp, Andor, ICRA 2016). Pure.
class PrecomputationGrids {
 public:
  static constexpr double kCell = 0.2;  ///< m
  static constexpr int kLevels = 6;     ///< up to 32 cells, 6.4 m

  /// Points in a levelled frame of which `reach` m either way of the origin in x and y matter.
  PrecomputationGrids(const std::vector<Eigen::Vector3f>& points, double reach);

  /// 0..1 at a point; 0 beyond the reach.
  [[nodiscard]] double at(const Eigen::Vector3f& point) const;
  /// Cells from the lattice's corner; the lattice is `side()` x `side()`, row by row.
  [[nodiscard]] int cell(double v) const;
  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] const std::vector<std::uint8_t>& level(int k) const { return levels_[static_cast<std::size_t>(k)]; }

 private:
  double reach_;
  int side_;
  std::vector<std::vector<std::uint8_t>> levels_;
};

}  // namespace curbstone::mapper::place_recognition
