#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/packing/spill_file.hpp"
#include "services/mapper/config/atlas_config.hpp"
#include "services/mapper/pose_graph/pose_graph.hpp"
#include "services/mapper/scan/keyframe.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::pose_graph {

/// The pose graph of the drive: a node per metre of new ground, and edges between nodes whose relative pose was
/// measured. Known ground gets no new nodes, so an hour of rounds takes no more memory than one round.
///
/// A node is *present* while its surroundings are part of the map for registration. The vehicle is always at a present
/// node, its *reference*. A loop closure moves the nodes' poses in `map`; the measurements, the edges, do not change. A
/// function of the calls alone. Pure; one thread.
class Atlas {
 public:
  static constexpr int kNone = -1;

  /// `spill_file`: file for the scans of all but the newest nodes; one without a folder keeps them in memory, packed.
  explicit Atlas(const config::AtlasConfig& config,
                 std::shared_ptr<SpillFile> spill_file = std::make_shared<SpillFile>())
      : config_(config), spill_file_(std::move(spill_file)) {}

  /// Reports a registered pose. Returns the node at the vehicle, which is created if there is none within `spacing`.
  int visit(std::int64_t utime, const Pose& T_map_base, const std::vector<scan::LidarPoint>& points);
  /// Reports that the map for registration was lost: only odometry connects the reference with the next visit().
  void leave();
  /// Reports a pose on known ground and selects the present node there as reference. Creates no node.
  void follow(const Pose& T_map_base);
  /// Adds a node of an earlier map as it is. To be called before the first visit().
  int add_known(scan::Keyframe node);
  void add_known(const PoseEdge& edge);
  /// Adds a node of this drive from the worker that created it; `driven`: m, as driven(). The node is not present.
  void restore(scan::Keyframe node, double driven);

  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] const scan::Keyframe& node(int id) const { return nodes_[static_cast<std::size_t>(id)].kept; }
  [[nodiscard]] int reference() const { return reference_; }
  /// m driven on new ground when the node was made.
  [[nodiscard]] double driven(int id) const { return nodes_[static_cast<std::size_t>(id)].driven; }
  [[nodiscard]] bool present(int id) const { return nodes_[static_cast<std::size_t>(id)].present; }
  /// Nodes of an earlier map are fixed: that map does not bend.
  [[nodiscard]] int num_known() const { return num_known_; }
  [[nodiscard]] const std::vector<PoseEdge>& edges() const { return edges_; }
  [[nodiscard]] std::vector<Pose> poses() const;

  /// Nodes within `radius` (horizontally, m) of a point, ordered by distance.
  [[nodiscard]] std::vector<int> near(const Eigen::Vector3d& point, double radius) const;
  /// Nodes that can be reached from a node along edges of at most `length` m in total, itself included; ordered by
  /// number. The length of an edge is that of a drive with the same uncertainty.
  [[nodiscard]] std::vector<int> connected(int from, double length) const;
  /// The node nearest to a point (horizontally) among those that have a scan; kNone if there is none.
  [[nodiscard]] int nearest(const Eigen::Vector3d& point) const;
  /// The reference, and the nodes within the window (any axis) that drift cannot have displaced against it.
  [[nodiscard]] std::vector<int> surroundings(int reference, const Eigen::Vector3d& centre, double window) const;

  /// Marks nodes farther than `window` (any axis) as absent: registration has dropped their surroundings.
  void forget_far(const Eigen::Vector3d& centre, double window);
  /// Returns absent nodes within the window that drift cannot have displaced, and marks them as present.
  [[nodiscard]] std::vector<int> take_returning(const Eigen::Vector3d& centre, double window);
  /// Makes exactly these nodes present, and sets the reference.
  void set_present(const std::vector<int>& ids, int reference);

  /// Adds a measured relative pose of two nodes that does not come from the drive between them.
  void add_loop(const PoseEdge& loop);
  /// Moves each node by its correction, T_new_old.
  void move(const std::vector<Pose>& corrections);
  /// Removes all nodes and edges made after `utime`, us.
  void roll_back(std::int64_t utime);

 private:
  struct Node {
    scan::Keyframe kept;
    double driven = 0;
    bool present = true;
    std::vector<int> edges;  // indices
  };
  [[nodiscard]] int nearest_present(const Eigen::Vector3d& point, double within) const;
  void connect(const PoseEdge& edge);
  [[nodiscard]] PoseEdge step(int from, int to, const Pose& T_from_to) const;
  [[nodiscard]] double length_of(const PoseEdge& edge) const;
  [[nodiscard]] bool linked(int a, int b) const;
  void bound_memory(const Eigen::Vector3d& centre);
  void spill(int id);

  config::AtlasConfig config_;
  std::shared_ptr<SpillFile> spill_file_;
  std::vector<Node> nodes_;
  std::vector<PoseEdge> edges_;
  std::set<int> present_;
  int reference_ = kNone;
  int num_known_ = 0;
  double driven_ = 0;
  bool left_ = false;  // see leave()
};

}  // namespace curbstone::mapper::pose_graph
