#pragma once

#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/config/loop_config.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/pose_graph/relocalizer.hpp"

namespace curbstone::mapper::pose_graph {

/// The vehicle is back at a place of long ago: seen from that node, it is here.
struct LoopClosure {
  int node = 0;
  Pose T_node_base = Pose::Identity();
  registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< in base_link axes
};

/// What a closure makes of the drive.
struct LoopCorrection {
  PoseEdge loop;                ///< to be added to the graph
  std::vector<Pose> T_new_old;  ///< of each node, by number
};

/// Looks out for places of long ago while the vehicle drives, and puts the drive right when two looks in a row agree.
/// Pure; one thread.
///
/// Counters: loops.looked, loops.seen (one look found the place), loops.disagreed (two did not agree), loops.closed,
/// loops.refused (the graph would have had to be bent too far).
class LoopCloser {
 public:
  explicit LoopCloser(const config::LoopConfig& config) : config_(config) {}

  /// `points`: a scan in base_link, taken at T_map_base.
  [[nodiscard]] std::optional<LoopClosure> look(const Atlas& atlas, const Relocalizer& relocalizer,
                                                const std::vector<scan::LidarPoint>& points, const Pose& T_map_base);
  /// Solves the atlas's graph with the closure in it; the vehicle is at T_map_base. Nothing if the closure contradicts
  /// the drive.
  [[nodiscard]] std::optional<LoopCorrection> solve(const Atlas& atlas, const LoopClosure& closure,
                                                    const Pose& T_map_base);
  /// Whether corrections are worth making the map anew.
  [[nodiscard]] bool matters(const LoopCorrection& correction, const Atlas& atlas) const;

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Seen {
    Pose correction;  // T_old_new: the vehicle as that place has it, of where it is thought to be
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
