#pragma once

#include <optional>

#include "common/vehicle.hpp"
#include "services/mapper/flat_index.hpp"
#include "services/mapper/loam_config.hpp"
#include "services/mapper/revolution.hpp"
#include "tools/evaluate/trajectory.hpp"
#include "tools/export/dense_cloud.hpp"

namespace curbstone {

/// The map that LOAM itself keeps of a drive (Zhang, Singh, RSS 2014): edge features a point each 0.2 m, plane features
/// a point each 0.4 m, as its authors' program thins them; all of the drive's, where theirs forgets what is far.
class LoamCloud {
 public:
  explicit LoamCloud(const VehicleConfig& vehicle, const LoamConfig& config = {});

  /// A revolution, and where the vehicle was at its end. It is de-skewed by steady motion since the one before; the
  /// first has none and is left out.
  void add(const Revolution& revolution, const StampedPose& pose);

  [[nodiscard]] const DenseCloud& cloud() const { return cloud_; }
  [[nodiscard]] std::size_t edges() const { return edges_.size(); }
  [[nodiscard]] std::size_t planes() const { return planes_.size(); }

  static constexpr double kEdgeVoxel = 0.2;   ///< m
  static constexpr double kPlaneVoxel = 0.4;  ///< m

 private:
  void take(const std::vector<LidarPoint>& features, const Pose& T_map_base, double voxel, FlatIndex& known);

  Pose T_base_lidar_;
  LoamConfig config_;
  std::optional<StampedPose> last_;
  FlatIndex edges_, planes_;
  DenseCloud cloud_;
};

}  // namespace curbstone
