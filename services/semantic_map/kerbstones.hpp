#pragma once

#include <Eigen/Core>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map {

/// The stones of curb lines: bright, narrow, and where the kerb is lowered hardly or not at all higher than the road.
class Kerbstones {
 public:
  explicit Kerbstones(const std::vector<tile::CurbLine>& curbs);
  /// Whether a place, m in map, is on a kerbstone.
  [[nodiscard]] bool contains(const Eigen::Vector2d& at) const;
  enum class Which { kRaised, kAll };  ///< kAll: lowered and flush ones, too
  /// Whether a kerb separates a road from a place, m in map: among the kerbs on the straight line between them, the one
  /// nearest to the place rises towards it. (Over a traffic island the line goes up and down again.) Beyond kerbs that
  /// are not raised there may be a road.
  [[nodiscard]] bool separates(const Eigen::Vector2d& road, const Eigen::Vector2d& at,
                               Which which = Which::kRaised) const;

 private:
  struct Vertex : tile::CurbVertex {
    bool is_raised = false;
  };
  void add(const std::vector<tile::CurbLine>& lines, bool are_flush);
  template <class Visit>
  void for_near(const Eigen::Vector2d& at, Visit visit) const;
  std::unordered_map<TileKey, std::vector<Vertex>, TileKeyHash> vertices_;  // by square
};

}  // namespace curbstone::semantic_map
