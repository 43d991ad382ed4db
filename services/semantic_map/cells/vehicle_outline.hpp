#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace curbstone::semantic_map::cells {

/// The ground that a vehicle occupies, estimated from its cells that were seen. From a passing vehicle, two sides of a
/// parked car are seen first: if they meet at a right angle, the outline is the rectangle that they span (as in L-shape
/// fitting: Zhang, Xu, Dong, Dolan, "Efficient L-Shape Fitting for Vehicle Detection Using Laser Scanners", IV 2017;
/// the directions here are those of the hull's edges). Otherwise it is their convex hull. Pure.
class VehicleOutline {
 public:
  using Cell = Eigen::Vector2i;

  /// `cells`: connected, each once. Nothing if they are smaller or larger than a vehicle, along their principal axes.
  [[nodiscard]] static std::optional<VehicleOutline> of(const std::vector<Cell>& cells);
  [[nodiscard]] bool contains(Cell cell) const;
  /// No cell beyond these, in x or in y, is contained.
  [[nodiscard]] Cell least() const { return least_; }
  [[nodiscard]] Cell most() const { return most_; }
  bool operator==(const VehicleOutline&) const = default;

 private:
  /// Extent of the cells' centres, in cells, along and across a direction.
  struct Rectangle {
    Eigen::Matrix2d axes;  // in its columns
    Eigen::Vector2d least;
    Eigen::Vector2d most;
    bool operator==(const Rectangle&) const = default;
  };
  [[nodiscard]] static Rectangle bounds(const std::vector<Cell>& cells, const Eigen::Matrix2d& axes);
  [[nodiscard]] static double sides_seen(const std::vector<Cell>& cells, const Rectangle& rectangle);
  void complete(const std::vector<Cell>& cells);
  void bound();

  Cell least_ = Cell::Zero();
  Cell most_ = Cell::Zero();
  std::vector<Cell> hull_;              // counter-clockwise
  std::optional<Rectangle> rectangle_;  // if two sides were seen
};

}  // namespace curbstone::semantic_map::cells
