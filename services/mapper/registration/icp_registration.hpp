#pragma once

#include <vector>

#include "services/mapper/config/icp_config.hpp"
#include "services/mapper/registration/plane_map.hpp"
#include "services/mapper/registration/plane_matches.hpp"
#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::registration {

/// Point-to-plane ICP on a voxel map of planes: Gauss-Newton over SE(3) with a Huber kernel and a Gaussian prior.
/// Directions that the surroundings do not constrain follow the prior (solution remapping, Zhang, Kaess, Singh, ICRA
/// 2016). A Gauss-Newton step is cheap and matching is expensive: correspondences are searched again only when the pose
/// has moved, and only for a subset of the points until the pose has settled.
class IcpRegistration final : public Registration {
 public:
  /// `lidar`: its position in base_link, m.
  IcpRegistration(const config::IcpConfig& config, const Eigen::Vector3d& lidar);

  [[nodiscard]] RegistrationResult align(const std::vector<scan::LidarPoint>& points, const PosePrior& prior) override;
  void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) override;
  void insert_keyframe(const scan::Keyframe& node) override;
  bool keep_around(const Eigen::Vector3d& centre) override;
  [[nodiscard]] double window() const override { return config_.window; }
  [[nodiscard]] std::vector<ShapeLevel*> levels() override { return map_.levels(); }
  [[nodiscard]] std::size_t size() const override { return map_.size(); }

 private:
  /// Finds the corresponding planes of every `stride`-th point.
  void match(const std::vector<scan::LidarPoint>& source, std::size_t stride, const Pose& T_map_base, double reach);

  config::IcpConfig config_;
  Eigen::Vector3f lidar_;
  PlaneMap map_;
  PlaneMatches matches_;  // scratch
  Eigen::Vector3d kept_around_ = Eigen::Vector3d::Zero();
};

}  // namespace curbstone::mapper::registration
