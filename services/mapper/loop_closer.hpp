#pragma once

#include <optional>
#include <vector>

#include "common/counters.hpp"
#include "services/mapper/atlas.hpp"
#include "services/mapper/loop_config.hpp"
#include "services/mapper/place_finder.hpp"

namespace curbstone {

/// The vehicle is back at a place of long ago: seen from that node, it is here.
struct LoopClosure {
  int node = 0;
  Pose T_node_base = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();  ///< in base_link axes
};

/// Looks out for places of long ago while the vehicle drives, and puts the drive right when two looks in a row agree.
/// Pure; one thread.
///
/// Counters: loops.looked, loops.seen (one look found the place), loops.disagreed (two did not agree), loops.closed,
/// loops.refused (the graph would have had to be bent too far).
class LoopCloser {
 public:
  explicit LoopCloser(const LoopConfig& config) : config_(config) {}

  /// `points`: a revolution in base_link, taken at T_map_base.
  [[nodiscard]] std::optional<LoopClosure> look(const Atlas& atlas, const PlaceFinder& finder,
                                                const std::vector<LidarPoint>& points, const Pose& T_map_base);
  /// Adds the closure to the atlas and solves its graph; the vehicle is at T_map_base. The corrections of all nodes,
  /// T_new_old; nothing if the closure contradicts the drive: then the atlas is as it was. Moves no node.
  [[nodiscard]] std::optional<std::vector<Pose>> solve(Atlas& atlas, const LoopClosure& closure,
                                                       const Pose& T_map_base);
  /// Whether corrections are worth making the map anew.
  [[nodiscard]] bool matters(const std::vector<Pose>& corrections, const Atlas& atlas) const;

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Seen {
    Pose correction;  // T_old_new: the vehicle as that place has it, of where it is thought to be
    double travelled = 0;
  };
  [[nodiscard]] bool bends_too_far(const std::vector<PoseEdge>& edges, const std::vector<double>& sigma) const;
  [[nodiscard]] int candidate(const Atlas& atlas, const Eigen::Vector3d& position) const;

  LoopConfig config_;
  std::optional<Eigen::Vector3d> last_position_;
  double travelled_ = 0;  // m
  double last_look_ = 0;  // of travelled_
  std::optional<Seen> seen_;
  Counters counters_;
};

}  // namespace curbstone
