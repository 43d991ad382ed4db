#pragma once

#include <array>

#include "services/semantic_map/tile/curb_parameters.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::ground {

/// Section VI, first step: "stick saliency and the direction of the normal" pick the points that may be ground; each
/// 0.25 m cell keeps the lowest layer of them.
struct GroundSample {
  float x = 0, y = 0;              ///< m from the tile's corner: centroid of the layer
  float z = 0;                     ///< m in map
  float slope_x = 0, slope_y = 0;  ///< mean slope by the normals: -n.x / n.z
  float spread = 0;                ///< m, RMS of the layer's heights about that slope
  int count = 0;                   ///< points; 0: no sample
  bool operator==(const GroundSample&) const = default;
};

/// The samples of a tile, row by row from its corner.
struct GroundSamples {
  static constexpr int kPerSide = 12;
  static constexpr double kCell = kTileSize / kPerSide;  ///< 0.25 m
  std::array<GroundSample, kPerSide * kPerSide> cells{};

  [[nodiscard]] const GroundSample& at(int column, int row) const {
    return cells[static_cast<std::size_t>(row * kPerSide + column)];
  }
  bool operator==(const GroundSamples&) const = default;
};

/// Computes the samples of one tile, without its neighbours.
[[nodiscard]] GroundSamples sample_ground(const tile::VotedTile& tile, const tile::CurbParameters& parameters);

/// The vote saw a single scan line, which is evidence neither for a surface nor against one.
[[nodiscard]] inline bool is_scan_line(const tile::VotedTensor& point) {
  return point.plate > 0.5F;
}

/// Whether the vote allows the point to be ground: its normal points up, and it lies on a surface or on a scan line.
[[nodiscard]] inline bool may_be_ground(const tile::VotedTensor& point, const tile::CurbParameters& parameters) {
  return point.mass > 0 && static_cast<double>(point.normal.z()) >= parameters.min_normal_z &&
         (static_cast<double>(point.stick) >= parameters.min_stick || is_scan_line(point));
}

}  // namespace curbstone::semantic_map::ground
