#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace curbstone::semantic_map::cells {

/// The ground that a vehicle takes up, estimated from the cells of it that were seen standing. Who passes a parked car
/// sees two of its sides first: where such meet at a right angle, the vehicle is the rectangle that they span (as in
/// L-shape fitting: Zhang, Xu, Dong, Dolan, "Efficient L-Shape Fitting for Vehicle Detection Using Laser Scanners",
/// IV 2017, whose directions here are those of the hull's edges). Else it is their convex hull. Pure.
class VehicleOutline {
 public:
  using Cell = Eigen::Vector2i;

  /// `cells` connected, each once. Nothing if they are smaller or larger than a vehicle, along their principal axes.
  [[nodiscard]] static std::optional<VehicleOutline> of(const std::vector<Cell>& cells);
  [[nodiscard]] bool contains(Cell cell) const;

 private:
  /// Cells' middles, in cells, along and across a direction.
  struct Rectangle {
    Eigen::Matrix2d axes;  // in its columns
    Eigen::Vector2d least;
    Eigen::Vector2d most;
  };
  [[nodiscard]] static Rectangle bounds(const std::vector<Cell>& cells, const Eigen::Matrix2d& axes);
  [[nodiscard]] static double sides_seen(const std::vector<Cell>& cells, const Rectangle& rectangle);
  void complete(const std::vector<Cell>& cells);

  std::vector<Cell> hull_;              // counter-clockwise
  std::optional<Rectangle> rectangle_;  // where two sides tell of it
};

}  // namespace curbstone::semantic_map::cells
