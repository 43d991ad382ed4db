#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "services/mapper/config/icp_config.hpp"
#include "services/mapper/place_recognition/lowest_points.hpp"
#include "services/mapper/place_recognition/precomputation_grids.hpp"
#include "services/mapper/registration/icp_registration.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::place_recognition {

/// Prior knowledge of the pose of a scan.
struct PlaceGuess {
  Pose T_map_base = Pose::Identity();  ///< roll and pitch must be accurate to a degree or two
  double reach = 5;                    ///< m, largest error of x and y; 50 at most
  double turn = 0.2;                   ///< rad, largest error of yaw; pi: unknown
};

/// A hypothesis, from which to register.
struct PlaceHypothesis {
  Pose T_map_base = Pose::Identity();
  double score = 0;  ///< 0..1: how well the scan's upright points match the map's
};

/// The registered pose of a scan, and the evidence for it.
struct PlaceMatch {
  registration::RegistrationResult registration;  ///< with pose and covariance
  double score = 0;                               ///< as in PlaceHypothesis, at the registered pose
  double conflict = 0;   ///< 0..1: share of the upright points in the other scan's view that its rays passed through
  double rise = 0;       ///< m by which the scan's ground is below the map's
  double runner_up = 0;  ///< score of the best distinct place; 0 if there is none
};

/// Searches the map's nodes around a guess for the pose of a scan. Pure; one thread; deterministic.
class CandidateSearch {
 public:
  /// Uses the nodes within 25 m of the possible positions, the nearest 30 at most. Any number of nodes may be given; of
  /// those used, spilled points are read. `lidar`: its position in base_link, m.
  CandidateSearch(const std::vector<const scan::Keyframe*>& nodes, const PlaceGuess& guess,
                  const config::IcpConfig& config, const Eigen::Vector3d& lidar);

  /// The best `most` distinct poses within the guess, best first. `points`: de-skewed, in base_link. None if the scan
  /// has no upright points, or if no nodes are near.
  [[nodiscard]] std::vector<PlaceHypothesis> hypotheses(const std::vector<scan::LidarPoint>& points, int most) const;

  /// Registers the scan from a hypothesis. The result is not checked.
  [[nodiscard]] PlaceMatch refine(const std::vector<scan::LidarPoint>& points, const PlaceHypothesis& hypothesis);

 private:
  [[nodiscard]] double score_at(const std::vector<Eigen::Vector3f>& standing, const Pose& T_local_level) const;
  [[nodiscard]] double conflict_at(const std::vector<scan::LidarPoint>& points,
                                   const std::vector<Eigen::Vector3f>& standing, const Pose& T_map_base) const;

  PlaceGuess guess_;
  config::IcpConfig config_;
  Eigen::Vector3d lidar_;
  std::vector<scan::Keyframe> nodes_;  // nearest first, in memory
  LowestPoints lowest_;                // in map axes, relative to the guess's position
  std::vector<Eigen::Vector3f> standing_;
  std::optional<PrecomputationGrids> grids_;
  std::unique_ptr<registration::IcpRegistration> registration_;  // created on demand
};

}  // namespace curbstone::mapper::place_recognition
