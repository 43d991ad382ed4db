#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::evaluate::truth {

/// A point on the foot of a true curb, world frame, m.
struct TrueCurbPoint {
  int line = 0;
  double x = 0;
  double y = 0;
  double z = 0;
  double height = 0;     ///< of the step
  bool dropped = false;  ///< a lowered curb: not scored
};

/// Classes of the ground as an image of the world, values as in semantic_tile_t.
struct TrueClasses {
  double resolution = 0.12;  ///< m per pixel
  double origin_x = 0;       ///< of the lower left corner, m
  double origin_y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< row 0 is the highest y

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  /// UNKNOWN outside.
  [[nodiscard]] std::uint8_t at(double x, double y) const;
  /// Has no effect outside.
  void set(double x, double y, std::uint8_t value);
  /// Whether the truth knows the ground on all sides of a place. Only there can a curb be scored as wrong.
  [[nodiscard]] bool known_around(double x, double y) const;

 private:
  [[nodiscard]] std::optional<std::size_t> index(double x, double y) const;
};

/// The files that `curbstone simulate` writes next to a drive. Recorded drives have poses, and may lack the rest.
struct Truth {
  Trajectory poses;  ///< T_world_base
  TrueClasses classes;
  /// The same in pixels much smaller than a map cell; empty if the truth is not known that precisely.
  TrueClasses fine_classes;
  std::vector<TrueCurbPoint> curbs;

  /// The true class of a map cell, `size` m wide, which T_truth_map transforms to the truth. With fine classes it
  /// follows the map's own rule: the highest class that the cell covers. It is UNKNOWN, so that no answer is wrong,
  /// where a cell `slack` m narrower on each side and one as much wider would have different classes, and where it is
  /// road that is not known everywhere. Without fine classes it is the class at the cell's centre: then a cell beside a
  /// wall may be either class, depending on how the two grids align.
  [[nodiscard]] std::uint8_t class_of_cell(const Pose& T_truth_map, const Eigen::Vector3d& centre, double size,
                                           double slack = 0) const;
};

/// Reads a truth folder: truth.json, poses.csv, classes.png, curbs.csv. Throws std::runtime_error with the file, the
/// line and what was expected.
[[nodiscard]] Truth load_truth(const std::string& folder);

}  // namespace curbstone::evaluate::truth
