#pragma once

#include <optional>
#include <vector>

#include "services/mapper/config/icp_config.hpp"
#include "services/mapper/place_recognition/candidate_search.hpp"
#include "services/mapper/place_recognition/scan_context.hpp"
#include "services/mapper/place_recognition/verify_place.hpp"
#include "services/mapper/pose_graph/atlas.hpp"

namespace curbstone::mapper::pose_graph {

/// Where a scan was taken.
struct FoundPlace {
  Pose T_map_base = Pose::Identity();
  registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< in base_link axes
  int node = 0;  ///< of the atlas, whose surroundings it was found in
};

/// Finds out where a scan was taken, by what the atlas remembers. Says nothing rather than guess. Pure; one
/// thread.
class Relocalizer {
 public:
  /// `lidar`: where it is in base_link, m.
  Relocalizer(const config::IcpConfig& config, const Eigen::Vector3d& lidar) : config_(config), lidar_(lidar) {}

  /// In the surroundings of one node, when the vehicle may be `reach` m and `turn` rad off the guess.
  [[nodiscard]] std::optional<FoundPlace> find_at(
      const Atlas& atlas, int node, const std::vector<scan::LidarPoint>& points, const Pose& guess, double reach,
      double turn, place_recognition::Known known = place_recognition::Known::kAll) const;
  /// Near a guess that may be `doubt` m off; where that is too far to search, anywhere that looks like it. The vehicle
  /// may have left the map a little way behind.
  [[nodiscard]] std::optional<FoundPlace> find(const Atlas& atlas, const std::vector<scan::LidarPoint>& points,
                                               const Pose& guess, double doubt);
  /// Whether so much doubt is too far to search. Much dearer.
  [[nodiscard]] static bool is_anywhere(double doubt);
  /// Nodes have been taken back: numbers may come to mean others.
  void forget();

 private:
  [[nodiscard]] std::optional<FoundPlace> find_anywhere(const Atlas& atlas, const std::vector<scan::LidarPoint>& points,
                                                        const Pose& guess);

  config::IcpConfig config_;
  Eigen::Vector3d lidar_;
  place_recognition::ScanContext index_;
  int indexed_ = 0;  // nodes of the atlas
};

}  // namespace curbstone::mapper::pose_graph
