#pragma once

#include <optional>
#include <vector>

#include "services/mapper/config/icp_config.hpp"
#include "services/mapper/place_recognition/candidate_search.hpp"
#include "services/mapper/place_recognition/scan_context.hpp"
#include "services/mapper/place_recognition/verify_place.hpp"
#include "services/mapper/pose_graph/atlas.hpp"

namespace curbstone::mapper::pose_graph {

/// The pose of a scan, found by relocalisation.
struct FoundPlace {
  Pose T_map_base = Pose::Identity();
  registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< in base_link axes
  int node = 0;  ///< of the atlas, in whose surroundings the pose was found
};

/// Finds the pose of a scan in the atlas. Returns nothing rather than an uncertain pose. Pure; one thread.
class Relocalizer {
 public:
  /// `lidar`: its position in base_link, m.
  Relocalizer(const config::IcpConfig& config, const Eigen::Vector3d& lidar) : config_(config), lidar_(lidar) {}

  /// Searches the surroundings of one node; the guess may be `reach` m and `turn` rad off.
  [[nodiscard]] std::optional<FoundPlace> find_at(
      const Atlas& atlas, int node, const std::vector<scan::LidarPoint>& points, const Pose& guess, double reach,
      double turn, place_recognition::Known known = place_recognition::Known::kAll) const;
  /// Searches near a guess that may be `uncertainty` m off; if that is too far, searches all places that look alike.
  /// The vehicle may be a little beyond the end of the map.
  [[nodiscard]] std::optional<FoundPlace> find(const Atlas& atlas, const std::vector<scan::LidarPoint>& points,
                                               const Pose& guess, double uncertainty);
  /// Whether `uncertainty` m is too far for a local search. The search of all places is much more expensive.
  [[nodiscard]] static bool needs_global_search(double uncertainty);
  /// Drops what was indexed: nodes have been removed, so numbers may refer to other nodes.
  void clear();

 private:
  [[nodiscard]] std::optional<FoundPlace> find_globally(const Atlas& atlas, const std::vector<scan::LidarPoint>& points,
                                                        const Pose& guess);

  config::IcpConfig config_;
  Eigen::Vector3d lidar_;
  place_recognition::ScanContext index_;
  int indexed_ = 0;  // nodes of the atlas
};

}  // namespace curbstone::mapper::pose_graph
