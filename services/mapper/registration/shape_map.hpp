#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "services/mapper/voxels/block_index.hpp"

namespace curbstone::mapper::registration {

enum class ShapeKind { kPlane, kLine };

/// A plane patch or an edge, in map.
struct MapShape {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();  ///< unit: a plane's normal, a line's direction; of either sign
  float variance = 0;                              ///< m^2, of the points about the shape, in the worst direction
};

/// Resolution of a level of the map, and the criteria for a plane or a line there.
struct ShapeLevelOptions {
  ShapeKind shape = ShapeKind::kPlane;
  double voxel = 0.3;         ///< m
  int capacity = 40;          ///< points of a voxel; further ones are ignored, so that the map does not drift
  int min_points = 6;         ///< in the 3 x 3 x 3 voxels that the shape is fitted to
  double max_flatness = 0.1;  ///< eigenvalue of the covariance across the shape, over the next larger one along it
  double min_width = 0.12;  ///< m: root of that larger eigenvalue; a narrower plane is a line, a narrower line a point
  double min_grazing = 0.05;  ///< sine of the mean angle at which rays met the plane: see fit()
};

/// A voxel as it is kept in a file.
struct VoxelSums {
  std::array<std::int32_t, 3> cell{};
  std::array<float, 13> sums{};  ///< the first: count of its points; see ShapeLevel::Moments
};

/// Voxel map of planes, or of lines. A voxel keeps count, sum and sum of squares of its points. A voxel's shape is
/// fitted to the moments of its 3 x 3 x 3 neighbourhood, which are plain sums: nothing is ever rebuilt, and the cost of
/// a point does not grow with the drive. Pure; one thread.
class ShapeLevel {
 public:
  explicit ShapeLevel(const ShapeLevelOptions& options);

  /// Points that are looked up together: see find().
  static constexpr std::size_t kTogether = 64;

  /// Adds points, in order. `rays`: unit vectors from the lidar to them. Both in map.
  void insert(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3f> rays);
  void insert(const Eigen::Vector3d& point, const Eigen::Vector3f& ray) {
    insert(std::span(&point, 1), std::span(&ray, 1));
  }
  /// To be called after the points of a scan: shapes that were fitted before it may be stale.
  void end_insertion() { ++version_; }

  /// The voxel that holds a point.
  struct Place {
    Eigen::Vector3i cell = Eigen::Vector3i::Zero();
    std::uint32_t voxel = voxels::BlockIndex::kNone;  // none exists yet
  };
  /// The places of up to kTogether points, valid until the next insert(). The map is larger than the CPU's caches:
  /// each step of the search fetches what the next one reads for all points, at last their shapes.
  void find(std::span<const Eigen::Vector3d> points, std::span<Place> places) const;

  /// The shape of the voxel that holds the point, or of the nearest neighbouring voxel; nullptr if there is none. The
  /// pointer is valid until the next insert().
  [[nodiscard]] const MapShape* shape_at(const Eigen::Vector3d& point);
  [[nodiscard]] const MapShape* shape_at(const Eigen::Vector3d& point, const Place& place);

  /// Drops voxels farther than `radius` m (in any axis) from `centre`, to within 2 voxels.
  void keep_around(const Eigen::Vector3d& centre, double radius);
  /// From here on the voxels that take points are noted for take_changed(). Those that are there count as changed.
  void note_changes();
  [[nodiscard]] bool notes_changes() const { return notes_changes_; }
  [[nodiscard]] std::size_t num_changed() const { return changed_.size(); }
  /// Up to `most` of the voxels that have changed, the first ones first, which then count as unchanged.
  [[nodiscard]] std::vector<VoxelSums> take_changed(std::size_t most);
  /// Takes voxels that take_changed() of another map gave, in that order. They count as unchanged, changes are noted.
  void restore(std::span<const VoxelSums> voxels);
  [[nodiscard]] std::size_t size() const { return moments_.size() - free_.size(); }

 private:
  /// Laid out so that four are added at a time. Offsets are from the voxel's centre.
  struct alignas(64) Moments {
    Eigen::Array4f first = Eigen::Array4f::Zero();    // count, sum of x y z
    Eigen::Array4f squares = Eigen::Array4f::Zero();  // sums of xx yy zz xy
    Eigen::Array4f rest = Eigen::Array4f::Zero();     // sums of xz yz; of the rays' x y
    float rays_z = 0;
    bool is_noted = false;  // as changed
  };
  struct Offset;
  struct Neighbourhood;
  struct alignas(64) Fitted {
    MapShape shape;
    std::int32_t version = -1;  // of the level when the shape was fitted
    std::int16_t patience = 1;  // versions until the shape is checked again
    bool valid = false;
    float count = 0;  // of the points that the shape was fitted to
  };

  [[nodiscard]] Eigen::Vector3d centre_of(const Eigen::Vector3i& cell) const;
  void search(std::span<const Eigen::Vector3d> points, std::span<Place> places) const;
  void add(const Eigen::Vector3d& point, const Eigen::Vector3f& ray, Place place);
  [[nodiscard]] std::uint32_t new_voxel();
  const MapShape* up_to_date(std::uint32_t voxel, const Eigen::Vector3i& cell);
  void fit(Fitted& fitted, const Eigen::Vector3i& cell) const;

  ShapeLevelOptions options_;
  double inverse_size_;
  std::int32_t version_ = 0;
  voxels::BlockIndex index_;
  std::vector<Moments> moments_;     // by voxel
  std::vector<Fitted> fitted_;       // by voxel
  std::vector<std::uint32_t> free_;  // voxels that were dropped
  bool notes_changes_ = false;
  std::vector<Eigen::Vector3i> changed_;  // cells; some may have been dropped since
};

}  // namespace curbstone::mapper::registration
