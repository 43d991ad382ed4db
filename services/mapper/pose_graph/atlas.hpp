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

/// The drive as a graph of places: a node each metre of new ground, edges between nodes whose relative pose was
/// measured. On known ground there are no new nodes, so an hour of rounds takes no more memory than one.
///
/// A node is *present* while its surroundings are part of the map for registration. The vehicle is always at a present
/// node, its *reference*. Positions in `map` move when a loop is closed; what was measured, the edges, does not.
/// A function of the calls alone. Pure; one thread.
class Atlas {
 public:
  static constexpr int kNone = -1;

  /// `far`: where the scans of all but the newest nodes are put away; without a folder in memory, packed.
  explicit Atlas(const config::AtlasConfig& config, std::shared_ptr<SpillFile> far = std::make_shared<SpillFile>())
      : config_(config), far_(std::move(far)) {}

  /// The vehicle was registered here: the node it is at, made if there is none within `spacing`.
  int visit(std::int64_t utime, const Pose& T_map_base, const std::vector<scan::LidarPoint>& points);
  /// Registration lost all that it knew, and only odometry leads from the reference to the next visit().
  void leave();
  /// The vehicle is here, on known ground: the present node that it is at now. Makes none.
  void follow(const Pose& T_map_base);
  /// Takes a node and edges of an earlier map as they are. Before the first visit().
  int add_known(scan::Keyframe node);
  void add_known(const PoseEdge& edge);
  /// Takes a node of this drive from who made it before; `driven`: m, as driven(). Not present.
  void restore(scan::Keyframe node, double driven);

  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] const scan::Keyframe& node(int id) const { return nodes_[static_cast<std::size_t>(id)].kept; }
  [[nodiscard]] int reference() const { return reference_; }
  /// m driven on new ground when the node was made.
  [[nodiscard]] double driven(int id) const { return nodes_[static_cast<std::size_t>(id)].driven; }
  [[nodiscard]] bool present(int id) const { return nodes_[static_cast<std::size_t>(id)].present; }
  /// Nodes that came with an earlier map stand fast: that map does not bend.
  [[nodiscard]] int num_known() const { return num_known_; }
  [[nodiscard]] const std::vector<PoseEdge>& edges() const { return edges_; }
  [[nodiscard]] std::vector<Pose> poses() const;

  /// Nodes within `radius` (horizontally, m) of a point, by distance.
  [[nodiscard]] std::vector<int> near(const Eigen::Vector3d& point, double radius) const;
  /// Nodes that can be reached from one along edges of at most `length` m altogether, itself included; by number. An
  /// edge is as long as a drive that would be as uncertain.
  [[nodiscard]] std::vector<int> connected(int from, double length) const;
  /// The node nearest to a point (horizontally) that has its scan; kNone if there is none.
  [[nodiscard]] int nearest(const Eigen::Vector3d& point) const;
  /// The reference, and the nodes within the window (any axis) that drift cannot have displaced from it.
  [[nodiscard]] std::vector<int> surroundings(int reference, const Eigen::Vector3d& centre, double window) const;

  /// Registration has forgotten what is farther than `window` (any axis): its nodes are absent from now on.
  void forget_far(const Eigen::Vector3d& centre, double window);
  /// Absent nodes within the window that drift cannot have displaced: they are present from now on.
  [[nodiscard]] std::vector<int> take_returning(const Eigen::Vector3d& centre, double window);
  /// Only these are present now, and the vehicle is at that one.
  void set_present(const std::vector<int>& ids, int reference);

  /// A measured pose of one node seen from another that no drive between them explains.
  void add_loop(const PoseEdge& loop);
  /// Moves each node by its correction, T_new_old.
  void move(const std::vector<Pose>& corrections);
  /// Forgets all nodes and edges made after `utime`.
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
  void put_away(int id);

  config::AtlasConfig config_;
  std::shared_ptr<SpillFile> far_;
  std::vector<Node> nodes_;
  std::vector<PoseEdge> edges_;
  std::set<int> present_;
  int reference_ = kNone;
  int num_known_ = 0;
  double driven_ = 0;
  bool left_ = false;  // see leave()
};

}  // namespace curbstone::mapper::pose_graph
