#pragma once

#include <cstdint>
#include <vector>

#include "services/localizer/monte_carlo/monte_carlo_config.hpp"
#include "services/localizer/tracking/pose_tracker.hpp"

namespace curbstone::localizer::monte_carlo {

/// Adaptive Monte Carlo localisation in the plane, as in AMCL: odometry motion model, likelihood field of upright
/// structures, KLD-adaptive number of particles, low-variance resampling (Thrun, Burgard, Fox, Probabilistic Robotics,
/// tables 5.6, 6.3, 8.4, 4.4). It serves for comparison with the tracker and does less: it does not detect when it is
/// lost. Random numbers are a function of seed, update and particle. One thread.
class ParticleFilter final : public tracking::PoseTracker {
 public:
  ParticleFilter(const tracking::PoseBelief& start, const MonteCarloConfig& config,
                 const tracking::TrackingConfig& odometry);

  tracking::PoseFit track(const tracking::ThinnedScan& scan, const tracking::Motion& motion,
                          fields::SavedMap& map) override;
  [[nodiscard]] const tracking::PoseBelief& belief() const override { return belief_; }
  [[nodiscard]] tracking::Matrix6 published_covariance() const override { return belief_.covariance; }
  [[nodiscard]] bool lost() const override { return false; }
  [[nodiscard]] std::size_t num_particles() const { return particles_.size(); }

 private:
  struct Particle {
    double x = 0, y = 0, yaw = 0;
    double weight = 1;
  };

  void move(const Pose& motion);
  void weigh(const std::vector<Eigen::Vector3d>& points, fields::SavedMap& map);
  void resample();
  [[nodiscard]] std::size_t wanted() const;
  void summarise(fields::SavedMap& map);
  /// A random number of this update for one particle; standard normal.
  [[nodiscard]] double normal(std::size_t particle, int draw) const;
  [[nodiscard]] double uniform(std::size_t particle, int draw) const;

  MonteCarloConfig config_;
  tracking::TrackingConfig odometry_;
  std::vector<Particle> particles_;
  tracking::PoseBelief belief_;
  Pose T_update_base_ = Pose::Identity();  // motion since the particles were moved
  std::uint64_t update_ = 0;
};

}  // namespace curbstone::localizer::monte_carlo
