#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace curbstone::mapper::place_recognition {

/// Likelihood of a place in the plane to return a ray from an upright object: 255 where the map has one, falling off
/// around it. Level k holds the maximum over the 2^k x 2^k cells that begin at a cell, an upper bound on the score of
/// all shifts within them (Olson, ICRA 2009; Hess, Kohler, Rapp, Andor, ICRA 2016). Pure.
class PrecomputationGrids {
 public:
  static constexpr double kCell = 0.2;  ///< m
  static constexpr int kLevels = 6;     ///< up to 32 cells, 6.4 m

  /// Points in a levelled frame; the grid covers `reach` m either way of the origin in x and y.
  PrecomputationGrids(const std::vector<Eigen::Vector3f>& points, double reach);

  /// Likelihood 0..1 at a point; 0 beyond the reach.
  [[nodiscard]] double at(const Eigen::Vector3f& point) const;
  /// Index of a coordinate from the lattice's corner; the lattice is `side()` x `side()`, row by row.
  [[nodiscard]] int cell(double v) const;
  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] const std::vector<std::uint8_t>& level(int k) const { return levels_[static_cast<std::size_t>(k)]; }

 private:
  double reach_;
  int side_;
  std::vector<std::vector<std::uint8_t>> levels_;
};

}  // namespace curbstone::mapper::place_recognition
