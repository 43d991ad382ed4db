#pragma once

#include "services/mapper/config/loam_config.hpp"
#include "services/mapper/registration/loam_solver.hpp"
#include "services/mapper/registration/plane_map.hpp"
#include "services/mapper/registration/ring_features.hpp"

namespace curbstone::mapper::registration {

/// LOAM's scan-to-map step (Zhang, Singh, RSS 2014, section VI) on voxel maps of edges and planes, with a Gaussian
/// prior. Directions that the surroundings do not constrain follow the prior.
class LoamRegistration final : public Registration {
 public:
  /// `lidar`: its position in base_link, m.
  LoamRegistration(const config::LoamConfig& config, const Eigen::Vector3d& lidar);

  [[nodiscard]] RegistrationResult align(const std::vector<scan::LidarPoint>& points, const PosePrior& prior) override;
  void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) override;
  void insert_keyframe(const scan::Keyframe& node) override;
  bool keep_around(const Eigen::Vector3d& centre) override;
  [[nodiscard]] double window() const override { return config_.window; }
  [[nodiscard]] std::vector<ShapeLevel*> levels() override {
    std::vector<ShapeLevel*> levels = planes_.levels();
    levels.push_back(&edges_);
    return levels;
  }
  [[nodiscard]] std::size_t size() const override { return planes_.size() + edges_.size(); }

 private:
  /// The matches of the features within reach at a pose, and the sums over them.
  struct Matching {
    std::vector<FeatureMatch> matches;
    NormalEquations sum;
  };
  [[nodiscard]] Matching match(const RingFeatures& features, const Pose& T_map_base, double reach);
  void add_match(const scan::LidarPoint& feature, const MapShape& shape, bool line, const Pose& T_map_base,
                 double reach, Matching& out) const;

  config::LoamConfig config_;
  Eigen::Vector3f lidar_;
  PlaneMap planes_;
  ShapeLevel edges_;
  Eigen::Vector3d kept_around_ = Eigen::Vector3d::Zero();
};

}  // namespace curbstone::mapper::registration
