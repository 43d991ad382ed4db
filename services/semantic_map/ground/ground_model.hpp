#pragma once

#include <array>
#include <optional>

#include "services/semantic_map/ground/ground_samples.hpp"
#include "services/semantic_map/ground/robust_plane.hpp"

namespace curbstone::semantic_map::ground {

/// A node of the digital elevation map: the refined ground around it.
struct GroundNode {
  bool valid = false;
  Plane plane;                                             ///< with the node as its reference point; heights: m in map
  Eigen::Vector2d normal_slope = Eigen::Vector2d::Zero();  ///< median slope by the normals nearby
  double normal_noise = 0;                                 ///< its noise (1 sigma, from the median deviation)
  double layer_noise = 0;  ///< m, 1 sigma of the ground's height from scan line to scan line
  /// Slope of all ground within 1.5 m, relative to that of the rough ground.
  Eigen::Vector2d coarse_tilt = Eigen::Vector2d::Zero();
  bool operator==(const GroundNode&) const = default;
};

/// The digital elevation map of a tile (section VI of the paper), in three layers. The rough ground is one robust plane
/// over the 9 m around the tile (the paper: 10 m). The road height is the lowest sample of each 0.5 m cell, unless its
/// neighbours are lower (tree tops, car roofs). The nodes, at the centres of the 3 x 3 squares of 1 m, each have a
/// robust plane of their own, so that slopes and crossfall are ground.
struct GroundModel {
  static constexpr int kPerSide = 3;
  static constexpr double kCell = kTileSize / kPerSide;  ///< 1 m
  std::array<GroundNode, kPerSide * kPerSide> nodes{};
  std::optional<Plane> rough;  ///< reference point: the tile's corner
  static constexpr int kRoadPerSide = 6;
  /// m in map, road height of the 0.5 m cells, row by row from the lowest y; NaN: none
  std::array<float, kRoadPerSide * kRoadPerSide> road{};

  [[nodiscard]] const GroundNode& at(int column, int row) const {
    return nodes[static_cast<std::size_t>(row * kPerSide + column)];
  }
};

/// Whether both models give the same GroundSurface. (It does not use the road heights, some of which are NaN.)
[[nodiscard]] inline bool is_same_surface(const GroundModel& a, const GroundModel& b) {
  return a.nodes == b.nodes && a.rough == b.rough;
}

/// Models the ground of a tile, from its samples and its neighbours'.
[[nodiscard]] GroundModel model_ground(const tile::Around<GroundSamples>& samples);

/// The ground at a place; slopes and noise as in GroundNode, in the axes of map.
struct GroundAt {
  double height = 0;                                       ///< m in map
  Eigen::Vector2d normal_slope = Eigen::Vector2d::Zero();  ///< by the normals
  double normal_noise = 0;                                 ///< 1 sigma of that
  double layer_noise = 0;                                  ///< m, 1 sigma
  Eigen::Vector2d coarse_tilt = Eigen::Vector2d::Zero();   ///< slope relative to the rough ground's
};

/// The part of GroundAt that every point needs.
struct GroundBelow {
  double height = 0;                                       ///< m in map
  Eigen::Vector2d normal_slope = Eigen::Vector2d::Zero();  ///< by the normals
  double normal_noise = 0;                                 ///< 1 sigma of that
};

/// The DEM over a tile and its neighbours, interpolated between the nodes: no jumps at borders.
class GroundSurface {
 public:
  explicit GroundSurface(const tile::Around<GroundModel>& models);
  /// x, y: m from the centre tile's corner. Nothing if no ground has been seen nearby.
  [[nodiscard]] std::optional<GroundAt> at(double x, double y) const;
  /// The same without the fields that few callers need.
  [[nodiscard]] std::optional<GroundBelow> below(double x, double y) const;
  [[nodiscard]] std::optional<double> height(double x, double y) const;
  /// As below(), but falls back to the rough ground of the centre tile: for walls where the ground is hidden.
  [[nodiscard]] std::optional<double> height_or_rough(double x, double y) const;

 private:
  friend class GroundColumns;
  static constexpr int kNodes = 3 * GroundModel::kPerSide;
  template <class Visit>
  double blend(double x, double y, Visit visit) const;
  std::array<const GroundNode*, kNodes * kNodes> nodes_{};
  std::optional<Plane> rough_;
};

}  // namespace curbstone::semantic_map::ground
