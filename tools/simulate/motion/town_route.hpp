#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::motion {

/// The line in plan view that a drive follows in the right-hand lane: points about one metre apart.
class TownRoute {
 public:
  /// Around the loop, repeatedly.
  [[nodiscard]] static TownRoute around(const world::Town& town);
  /// In by the street that leads out of the loop, once around, and out by it: against the first direction. Only in a
  /// town of several blocks.
  [[nodiscard]] static TownRoute there_and_back(const world::Town& town);

  /// Along the straight street, from shortly after its beginning to shortly before its end.
  [[nodiscard]] static TownRoute along(const world::Town& town);

  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] int size() const { return static_cast<int>(points_.size()) - 2; }
  /// -1 <= i <= size(): one point beyond either end.
  [[nodiscard]] const Eigen::Vector2d& at(int i) const { return points_[static_cast<std::size_t>(i + 1)]; }
  /// m, in straight lines from point to point; of a closed route, one lap.
  [[nodiscard]] double length() const;

 private:
  TownRoute(std::vector<Eigen::Vector2d> points, bool closed) : points_(std::move(points)), closed_(closed) {}
  std::vector<Eigen::Vector2d> points_;  // with one additional point at each end
  bool closed_;
};

}  // namespace curbstone::simulate::motion
