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

/// Where a scan may have been taken.
struct PlaceGuess {
  Pose T_map_base = Pose::Identity();  ///< its roll and pitch must be good to a degree or two
  double reach = 5;                    ///< m, that x and y may be off by; 50 at most
  double turn = 0.2;                   ///< rad, that yaw may be off by; pi: it may be any
};

/// A pose worth registering from.
struct PlaceHypothesis {
  Pose T_map_base = Pose::Identity();
  double score = 0;  ///< 0..1: how well what stands upright in the scan falls on what does in the map
};

/// Where a scan was taken, and what speaks for it.
struct PlaceMatch {
  registration::RegistrationResult registration;  ///< pose and covariance are here
  double score = 0;                               ///< as of PlaceHypothesis, at that pose
  double conflict = 0;   ///< 0..1: of what stands in one scan within the sight of another, the share it looked through
  double rise = 0;       ///< m by which the ground of the scan is under the map's
  double runner_up = 0;  ///< score of the best that is another place; 0 where none came near
};

/// What nodes of the map show of the surroundings of a guess, ready to be searched. Pure; one thread; deterministic.
class CandidateSearch {
 public:
  /// Of the nodes, those within 25 m of where the vehicle may be count, the nearest 30 at most. They may be given in
  /// any number; of those that count, points that are away are read. `lidar`: where it is in base_link, m.
  CandidateSearch(const std::vector<const scan::Keyframe*>& nodes, const PlaceGuess& guess,
                  const config::IcpConfig& config, const Eigen::Vector3d& lidar);

  /// The best `most` poses within the guess that are not each other's neighbours, best first. `points`: de-skewed, in
  /// base_link. None where nothing upright is seen, or no nodes are near.
  [[nodiscard]] std::vector<PlaceHypothesis> hypotheses(const std::vector<scan::LidarPoint>& points, int most) const;

  /// Registers the scan from a hypothesis; whatever comes of it.
  [[nodiscard]] PlaceMatch refine(const std::vector<scan::LidarPoint>& points, const PlaceHypothesis& hypothesis);

 private:
  [[nodiscard]] double score_at(const std::vector<Eigen::Vector3f>& standing, const Pose& T_local_level) const;
  [[nodiscard]] double conflict_at(const std::vector<scan::LidarPoint>& points,
                                   const std::vector<Eigen::Vector3f>& standing, const Pose& T_map_base) const;

  PlaceGuess guess_;
  config::IcpConfig config_;
  Eigen::Vector3d lidar_;
  std::vector<scan::Keyframe> nodes_;  // nearest first, in memory
  LowestPoints lowest_;                // in map, from the guess's position on
  std::vector<Eigen::Vector3f> standing_;
  std::optional<PrecomputationGrids> grids_;
  std::unique_ptr<registration::IcpRegistration> registration_;  // made when it is needed
};

}  // namespace curbstone::mapper::place_recognition
