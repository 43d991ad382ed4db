#pragma once

#include <Eigen/Core>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map {

/// The stones of curb lines: bright, narrow, and where the kerb is lowered hardly higher than the road, or not at all.
class Kerbstones {
 public:
  explicit Kerbstones(const std::vector<tile::CurbLine>& curbs);
  /// Whether a place, m in map, is on one of them.
  [[nodiscard]] bool hold(const Eigen::Vector2d& at) const;

 private:
  void add(const std::vector<tile::CurbLine>& lines);
  std::unordered_map<TileKey, std::vector<tile::CurbVertex>, TileKeyHash> vertices_;  // by square
};

}  // namespace curbstone::semantic_map
