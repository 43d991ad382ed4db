#pragma once

#include <array>
#include <cstddef>

#include "services/semantic_map/ground/ground_model.hpp"

namespace curbstone::semantic_map::ground {

/// A GroundSurface evaluated at many places at once, vectorised. The results are those of the surface, bit for bit. x,
/// y: as there, of `n` places at most kReach outside the centre tile.
class GroundColumns {
 public:
  static constexpr double kReach = kTileSize - GroundModel::kCell;  ///< m: within the outer nodes
  explicit GroundColumns(const GroundSurface& surface);
  /// As GroundSurface::height(); NaN where no ground has been seen nearby.
  void heights(const double* x, const double* y, std::size_t n, double* height) const;
  /// The other values of GroundSurface::below(); NaN likewise.
  void normals(const double* x, const double* y, std::size_t n, double* slope_x, double* slope_y, double* noise) const;

  static constexpr int kNodes = GroundSurface::kNodes;  ///< along one side
  using Nodes = std::array<double, std::size_t{kNodes} * kNodes>;

 private:
  Nodes valid_{};  // 1; 0 where there is no node, whose other values are 0 too
  Nodes height_{}, slope_x_{}, slope_y_{};
  Nodes normal_x_{}, normal_y_{}, noise_{};
};

}  // namespace curbstone::semantic_map::ground
