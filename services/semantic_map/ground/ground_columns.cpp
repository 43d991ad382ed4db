#include "services/semantic_map/ground/ground_columns.hpp"

#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::ground {

namespace {

constexpr int kNodes = GroundColumns::kNodes;

/// The four nodes around a place and their weights, as in GroundSurface::blend(). The same operations in the same
/// order, but without branches: a node without weight adds 0, and no place lies beyond the outer nodes.
struct Corners {
  int first;                  // the node of the lowest column and row
  double w00, w01, w10, w11;  // by row and column
  double left, right;         // m in x, from the nodes of either column
  double below, above;        // m in y
  double sum;                 // of the weights

  /// `valid`: 1 or 0, of each node.
  [[gnu::always_inline]] Corners(double x, double y, const double* valid) {
    const double column = (x + kTileSize) / GroundModel::kCell - 0.5;
    const double row = (y + kTileSize) / GroundModel::kCell - 0.5;
    const int c0 = static_cast<int>(column);
    const int r0 = static_cast<int>(row);
    const double fx = column - c0;
    const double fy = row - r0;
    first = r0 * kNodes + c0;
    w00 = (1 - fx) * (1 - fy) * valid[first];
    w01 = fx * (1 - fy) * valid[first + 1];
    w10 = (1 - fx) * fy * valid[first + kNodes];
    w11 = fx * fy * valid[first + kNodes + 1];
    left = fx * GroundModel::kCell;
    right = (column - c0 - 1) * GroundModel::kCell;
    below = fy * GroundModel::kCell;
    above = (row - r0 - 1) * GroundModel::kCell;
    sum = 0;
    sum += w00;
    sum += w01;
    sum += w10;
    sum += w11;
  }
  /// The weighted mean of the nodes' values, in the order of the weights. NaN (0 / 0) if there is no node.
  [[gnu::always_inline]] double mean(double v00, double v01, double v10, double v11) const {
    double total = 0;
    total += w00 * v00;
    total += w01 * v01;
    total += w10 * v10;
    total += w11 * v11;
    return total / sum;
  }
  [[gnu::always_inline]] double mean(const double* of_nodes) const {
    return mean(of_nodes[first], of_nodes[first + 1], of_nodes[first + kNodes], of_nodes[first + kNodes + 1]);
  }
};

CURBSTONE_VECTORISED
void blend_heights(const double* valid, const double* height, const double* slope_x, const double* slope_y,
                   const double* x, const double* y, std::size_t n, double* __restrict result) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const Corners c(x[i], y[i], valid);
    const int k = c.first;
    result[i] = c.mean(height[k] + slope_x[k] * c.left + slope_y[k] * c.below,
                       height[k + 1] + slope_x[k + 1] * c.right + slope_y[k + 1] * c.below,
                       height[k + kNodes] + slope_x[k + kNodes] * c.left + slope_y[k + kNodes] * c.above,
                       height[k + kNodes + 1] + slope_x[k + kNodes + 1] * c.right + slope_y[k + kNodes + 1] * c.above);
  }
}

CURBSTONE_VECTORISED
void blend_normals(const double* valid, const double* normal_x, const double* normal_y, const double* noise,
                   const double* x, const double* y, std::size_t n, double* __restrict result_x,
                   double* __restrict result_y, double* __restrict result_noise) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const Corners corners(x[i], y[i], valid);
    result_x[i] = corners.mean(normal_x);
    result_y[i] = corners.mean(normal_y);
    result_noise[i] = corners.mean(noise);
  }
}

}  // namespace

GroundColumns::GroundColumns(const GroundSurface& surface) {
  for (std::size_t i = 0; i < valid_.size(); ++i) {
    const GroundNode* const node = surface.nodes_[i];
    if (node == nullptr) continue;
    valid_[i] = 1;
    height_[i] = node->plane.height;
    slope_x_[i] = node->plane.slope.x();
    slope_y_[i] = node->plane.slope.y();
    normal_x_[i] = node->normal_slope.x();
    normal_y_[i] = node->normal_slope.y();
    noise_[i] = node->normal_noise;
  }
}

void GroundColumns::heights(const double* x, const double* y, std::size_t n, double* height) const {
  blend_heights(valid_.data(), height_.data(), slope_x_.data(), slope_y_.data(), x, y, n, height);
}

void GroundColumns::normals(const double* x, const double* y, std::size_t n, double* slope_x, double* slope_y,
                            double* noise) const {
  blend_normals(valid_.data(), normal_x_.data(), normal_y_.data(), noise_.data(), x, y, n, slope_x, slope_y, noise);
}

}  // namespace curbstone::semantic_map::ground
