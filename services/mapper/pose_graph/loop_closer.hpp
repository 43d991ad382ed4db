#pragma once

#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/config/loop_config.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/pose_graph/relocalizer.hpp"

namespace curbstone::mapper::pose_graph {

/// A recognised place: the vehicle's pose relative to a node of long ago.
struct LoopClosure {
  int node = 0;
  Pose T_node_base = Pose::Identity();
  registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< in base_link axes
};

/// The correction of the drive that a loop closure gives.
struct LoopCorrection {
  PoseEdge loop;                ///< to be added to the graph
  std::vector<Pose> T_new_old;  ///< by number of the node
};

/// Searches for places of long ago while the vehicle drives, and corrects the drive when two successive searches agree.
/// Pure; one thread.
///
/// Counters: loops.looked, loops.seen (a search found a place), loops.disagreed (two did not agree), loops.closed,
/// loops.refused (the graph would have been bent too far).
class LoopCloser {
 public:
  explicit LoopCloser(const config::LoopConfig& config) : config_(config) {}

  /// Searches with a scan; `points`: in base_link, taken at T_map_base.
  [[nodiscard]] std::optional<LoopClosure> search(const Atlas& atlas, const Relocalizer& relocalizer,
                                                  const std::vector<scan::LidarPoint>& points, const Pose& T_map_base);
  /// Optimises the atlas's graph with the closure added; the vehicle is at T_map_base. Nothing if the closure
  /// contradicts the drive.
  [[nodiscard]] std::optional<LoopCorrection> solve(const Atlas& atlas, const LoopClosure& closure,
                                                    const Pose& T_map_base) const;
  /// Counts what solve() returned, which may have been called on a copy.
  void note_solved(const std::optional<LoopCorrection>& correction) {
    counters_.add(correction ? "loops.closed" : "loops.refused");
  }
  /// Whether the correction is large enough to rebuild the map.
  [[nodiscard]] bool is_significant(const LoopCorrection& correction, const Atlas& atlas) const;

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Seen {
    Pose correction;  // T_old_new: takes the current estimate to the pose by the recognised place
    double travelled = 0;
  };
  [[nodiscard]] bool bends_too_far(const std::vector<PoseEdge>& edges, const std::vector<double>& sigma) const;
  [[nodiscard]] int candidate(const Atlas& atlas, const Eigen::Vector3d& position) const;

  config::LoopConfig config_;
  std::optional<Eigen::Vector3d> last_position_;
  double travelled_ = 0;  // m
  double last_look_ = 0;  // of travelled_
  std::optional<Seen> seen_;
  Counters counters_;
};

}  // namespace curbstone::mapper::pose_graph
