#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tools/simulate/world/scene.hpp"

namespace curbstone::bench::curbs::scenes {

/// A street with exact truth, with one curb on each side or none. The road runs along x from the origin, or bends; the
/// vehicle stands or drives on the line y = 0 (on a bent road: on a circle).
struct CurbSceneOptions {
  std::string name;
  double height = 0.15;  ///< m, of both curbs; 0: the road's edge is flush, and every detection is wrong
  double noise = 0.02;   ///< m, 1 sigma of a range
  double left = 4.0;     ///< m from the vehicle's line to the foot of the left curb
  double right = 4.0;
  double crossfall = 0.02;   ///< of the carriageway at the gutter
  double tilt = 0;           ///< slope of the whole scene to the left
  double slope = 0;          ///< slope of the whole scene ahead
  double curvature = 0;      ///< 1/m, positive to the left
  double pavement = 2.3;     ///< m from the foot to the grass; 0.15 or more
  double tufts = 0.03;       ///< m, maximum height of the grass
  bool parked_cars = false;  ///< along both curbs, with gaps
  bool hedges = false;       ///< 0.5 m behind both curbs
};

/// The six scenes of the comparison with other methods.
[[nodiscard]] std::vector<CurbSceneOptions> peer_scenes();
/// Further scenes, on which no parameter was tuned.
[[nodiscard]] std::vector<CurbSceneOptions> varied_scenes();

/// The generated scene. Frame: world, z up; the vehicle's line begins at the origin.
class CurbScene {
 public:
  explicit CurbScene(const CurbSceneOptions& options, std::uint64_t seed = 1);

  [[nodiscard]] const CurbSceneOptions& options() const { return options_; }
  [[nodiscard]] const simulate::world::Scene& scene() const { return scene_; }
  [[nodiscard]] bool has_curbs() const { return options_.height > 0; }

  /// A point on the ground: s m along the vehicle's line, y m to its left.
  [[nodiscard]] Eigen::Vector3d place(double s, double y) const;
  /// base_link on the vehicle's line, s m along it, on the ground.
  [[nodiscard]] Pose T_world_base(double s) const;
  /// The inverse of place(): (s, y) of a point.
  [[nodiscard]] Eigen::Vector2d along_road(double x, double y) const;
  /// Whether the face of the curb at s on a side (+1 left, -1 right) is visible from a point.
  [[nodiscard]] bool sees_curb(const Eigen::Vector3d& from, double s, int side) const;

 private:
  CurbSceneOptions options_;
  simulate::world::Scene scene_;
};

}  // namespace curbstone::bench::curbs::scenes
