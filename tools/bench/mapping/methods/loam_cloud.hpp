#pragma once

#include <optional>

#include "common/config/vehicle.hpp"
#include "services/mapper/config/loam_config.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/voxels/flat_index.hpp"
#include "tools/evaluate/truth/trajectory.hpp"
#include "tools/export/dense_cloud.hpp"

namespace curbstone::bench::mapping::methods {

/// The map that LOAM itself keeps of a drive (Zhang, Singh, RSS 2014): edge features thinned to 0.2 m, plane features
/// to 0.4 m, as in its authors' program. It keeps the whole drive, where theirs discards distant points.
class LoamCloud {
 public:
  explicit LoamCloud(const VehicleConfig& vehicle, const mapper::config::LoamConfig& config = {});

  /// Adds a revolution with the vehicle's pose at its end. It is de-skewed with constant motion since the revolution
  /// before; the first one has none and is left out.
  void add(const mapper::scan::Scan& scan, const evaluate::truth::StampedPose& pose);

  [[nodiscard]] const map_export::DenseCloud& cloud() const { return cloud_; }
  [[nodiscard]] std::size_t edges() const { return edges_.size(); }
  [[nodiscard]] std::size_t planes() const { return planes_.size(); }

  static constexpr double kEdgeVoxel = 0.2;   ///< m
  static constexpr double kPlaneVoxel = 0.4;  ///< m

 private:
  void take(const std::vector<mapper::scan::LidarPoint>& features, const Pose& T_map_base, double voxel,
            mapper::voxels::FlatIndex& known);

  Pose T_base_lidar_;
  mapper::config::LoamConfig config_;
  std::optional<evaluate::truth::StampedPose> last_;
  mapper::voxels::FlatIndex edges_, planes_;
  map_export::DenseCloud cloud_;
};

}  // namespace curbstone::bench::mapping::methods
