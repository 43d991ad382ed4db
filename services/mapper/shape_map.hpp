#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "services/mapper/flat_index.hpp"

namespace curbstone {

enum class ShapeKind { kPlane, kLine };

/// A piece of surface, or of an edge, in map.
struct MapShape {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();  ///< unit: a plane's normal, a line's direction; of either sign
  float variance = 0;                              ///< m^2, of the points about it, in the worst direction
};

/// How finely a level of the map looks, and what passes for a plane or a line there.
struct ShapeLevelOptions {
  ShapeKind shape = ShapeKind::kPlane;
  double voxel = 0.3;         ///< m
  int capacity = 40;          ///< points of a voxel; more are not taken, so that the map stays where it was built
  int min_points = 6;         ///< in the 3 x 3 x 3 voxels that a shape is fitted to
  double max_flatness = 0.1;  ///< eigenvalue of the covariance across the shape, over the next larger one along it
  double min_width = 0.12;    ///< m: root of the latter; a plane of less is a line, a line of less a point
  double min_grazing = 0.05;  ///< sine of the angle at which rays must have met a plane, in the mean: see fit()
};

/// The world as planes, or as lines, in a lattice of voxels. A voxel keeps count, sum and sum of squares of its points;
/// the shape of a voxel is fitted to these moments over its 3 x 3 x 3 neighbourhood, which are plain sums: nothing is
/// ever rebuilt, and a point costs the same on the first day as on the last. Pure; one thread.
class ShapeLevel {
 public:
  explicit ShapeLevel(const ShapeLevelOptions& options);

  /// `ray`: unit vector from the lidar to the point, in map.
  void insert(const Eigen::Vector3f& point, const Eigen::Vector3f& ray);
  /// Call after the points of a revolution: what was fitted before it may now be stale.
  void end_insertion() { ++version_; }

  /// Where a point was looked up last; good until the next insert(). A point that hardly moved is found without a
  /// search.
  struct Place {
    VoxelKey key = ~VoxelKey{0};
    unsigned side = 8;  // of the voxel's centre, a bit an axis; 8: not looked
    std::uint32_t own = FlatIndex::kNone;
    std::array<std::uint32_t, 3> beside{};
  };
  /// The shape of the voxel that holds the point, or of the nearest one beside it; nullptr if there is none.
  /// The pointer lives until the next insert().
  [[nodiscard]] const MapShape* shape_at(const Eigen::Vector3f& point, Place& place);
  [[nodiscard]] const MapShape* shape_at(const Eigen::Vector3f& point) {
    Place anywhere;
    return shape_at(point, anywhere);
  }

  /// Forgets voxels farther than `radius` (in any axis) from `centre`.
  void keep_around(const Eigen::Vector3f& centre, float radius);
  [[nodiscard]] std::size_t size() const { return voxels_.size(); }

 private:
  struct Moments {
    float count = 0;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();                            // of offsets from the voxel's centre
    Eigen::Matrix<float, 6, 1> squares = Eigen::Matrix<float, 6, 1>::Zero();  // xx xy xz yy yz zz of them
    Eigen::Vector3f rays = Eigen::Vector3f::Zero();                           // sum
  };
  struct Voxel {
    Eigen::Vector3i cell;
    Moments moments;
    MapShape shape;
    bool valid = false;
    std::int32_t fitted = -1;   // version at which the shape was fitted
    std::int32_t patience = 1;  // versions until it is looked at again
    float fitted_count = 0;
  };

  [[nodiscard]] Eigen::Vector3f centre_of(const Eigen::Vector3i& cell) const;
  const MapShape* up_to_date(Voxel& voxel);
  void fit(Voxel& voxel);

  ShapeLevelOptions options_;
  double inverse_size_;
  std::int32_t version_ = 0;
  FlatIndex index_;
  std::vector<Voxel> voxels_;
};

}  // namespace curbstone
