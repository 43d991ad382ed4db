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
  bool dropped = false;  ///< a lowered kerb: found or not, it does not count
};

/// Classes of the ground as an image of the world, values as in semantic_tile_t.
struct TrueClasses {
  double resolution = 0.12;  ///< m a pixel
  double origin_x = 0;       ///< of the lower left corner, m
  double origin_y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< row 0 is the highest y

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  /// UNKNOWN outside.
  [[nodiscard]] std::uint8_t at(double x, double y) const;
  /// Nothing happens outside.
  void set(double x, double y, std::uint8_t value);
  /// Whether the truth knows the ground on all sides of a place: only there a curb can be called wrong.
  [[nodiscard]] bool known_around(double x, double y) const;

 private:
  [[nodiscard]] std::optional<std::size_t> index(double x, double y) const;
};

/// What `curbstone simulate` writes beside a drive. Recorded drives have poses, and may lack the rest.
struct Truth {
  Trajectory poses;  ///< T_world_base
  TrueClasses classes;
  /// The same in pixels that are small beside a cell of a map; empty where nobody knows it so well.
  TrueClasses fine_classes;
  std::vector<TrueCurbPoint> curbs;

  /// What truly is in a cell of a map, `size` m wide, which T_truth_map lays on the truth. By the fine classes it is
  /// what the map's own rule makes of it: the highest class of all that the cell meets. UNKNOWN, so that neither answer
  /// is wrong, where a cell `slack` m narrower on each side and one as much wider would be different ones, and where it
  /// is road that is not known everywhere. Without fine classes it is the class at the cell's centre: then a cell
  /// beside a wall may be either, as the two grids lie.
  [[nodiscard]] std::uint8_t class_of_cell(const Pose& T_truth_map, const Eigen::Vector3d& centre, double size,
                                           double slack = 0) const;
};

/// Reads a truth folder: truth.json, poses.csv, classes.png, curbs.csv. Throws std::runtime_error with file, line and
/// what was expected.
[[nodiscard]] Truth load_truth(const std::string& folder);

}  // namespace curbstone::evaluate::truth
