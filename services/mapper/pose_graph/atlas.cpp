#include "services/mapper/pose_graph/atlas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

#include "services/mapper/scan/downsample.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

std::vector<scan::KeyframePoint> node_points(const std::vector<scan::LidarPoint>& points,
                                             const config::AtlasConfig& config) {
  std::vector<scan::KeyframePoint> kept;
  for (const scan::LidarPoint& point : scan::downsample(points, config.node_voxel, config.node_range)) {
    if (const auto packed = scan::pack(point.position)) kept.push_back(*packed);
  }
  kept.shrink_to_fit();
  return kept;
}

constexpr int kMaxScansInMemory = 20;    // the newest nodes: writing their scans needs no reading back
constexpr double kOdometryDrift = 0.02;  // m per metre, of odometry alone

double far_in_any_axis(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace

int Atlas::visit(std::int64_t utime, const Pose& T_map_base, const std::vector<scan::LidarPoint>& points) {
  const int nearest = nearest_present(T_map_base.translation(), config_.spacing);
  if (nearest != kNone) {
    if (nearest != reference_ && reference_ != kNone && !linked(reference_, nearest)) {
      connect(step(reference_, nearest, node(reference_).T_map_base.inverse() * node(nearest).T_map_base));
    }
    reference_ = nearest;
    return reference_;
  }
  const int made = size();
  if (reference_ != kNone) driven_ += (node(reference_).T_map_base.inverse() * T_map_base).translation().norm();
  nodes_.push_back({{utime, T_map_base, node_points(points, config_)}, driven_, true, {}});
  present_.insert(made);
  if (made >= kMaxScansInMemory) spill(made - kMaxScansInMemory);
  if (reference_ != kNone) connect(step(reference_, made, node(reference_).T_map_base.inverse() * T_map_base));
  reference_ = made;
  left_ = false;
  bound_memory(T_map_base.translation());
  return reference_;
}

void Atlas::leave() {
  set_present({}, reference_);
  left_ = true;
}

void Atlas::follow(const Pose& T_map_base) {
  const int nearest = nearest_present(T_map_base.translation(), std::numeric_limits<double>::infinity());
  if (nearest != kNone) reference_ = nearest;
}

int Atlas::add_known(scan::Keyframe node) {
  nodes_.push_back({std::move(node), driven_, false, {}});
  num_known_ = size();
  spill(num_known_ - 1);
  spill_file_->flush_much();
  return num_known_ - 1;
}

void Atlas::add_known(const PoseEdge& edge) {
  connect(edge);
}

void Atlas::restore(scan::Keyframe node, double driven) {
  driven_ = driven;
  nodes_.push_back({std::move(node), driven, false, {}});
  spill(size() - 1);
  spill_file_->flush_much();
}

void Atlas::spill(int id) {
  nodes_[static_cast<std::size_t>(id)].kept.points.spill(*spill_file_);
}

std::vector<Pose> Atlas::poses() const {
  std::vector<Pose> poses;
  poses.reserve(nodes_.size());
  for (const Node& node : nodes_) poses.push_back(node.kept.T_map_base);
  return poses;
}

/// Distance in space: a bridge is a different place from the road below.
int Atlas::nearest_present(const Eigen::Vector3d& point, double within) const {
  int best = kNone;
  double distance = within;
  for (const int id : present_) {
    const double d = (node(id).T_map_base.translation() - point).norm();
    if (d >= distance) continue;
    distance = d;
    best = id;
  }
  return best;
}

std::vector<int> Atlas::near(const Eigen::Vector3d& point, double radius) const {
  std::vector<std::pair<double, int>> found;
  for (int id = 0; id < size(); ++id) {
    const double d = (node(id).T_map_base.translation() - point).head<2>().norm();
    if (d <= radius && !node(id).points.empty()) found.emplace_back(d, id);
  }
  std::sort(found.begin(), found.end());
  std::vector<int> ids;
  for (const auto& [d, id] : found) ids.push_back(id);
  return ids;
}

/// Dijkstra's algorithm, bounded by the length.
std::vector<int> Atlas::connected(int from, double length) const {
  std::map<int, double> reached;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  front.emplace(0.0, from);
  while (!front.empty()) {
    const auto [path, id] = front.top();
    front.pop();
    if (!reached.try_emplace(id, path).second) continue;
    for (const int e : nodes_[static_cast<std::size_t>(id)].edges) {
      const PoseEdge& edge = edges_[static_cast<std::size_t>(e)];
      const int next = edge.from == id ? edge.to : edge.from;
      const double there = path + length_of(edge);
      if (there <= length && !reached.contains(next)) front.emplace(there, next);
    }
  }
  std::vector<int> ids;
  for (const auto& [id, path] : reached) ids.push_back(id);
  return ids;
}

int Atlas::nearest(const Eigen::Vector3d& point) const {
  const std::vector<int> all = near(point, std::numeric_limits<double>::infinity());
  return all.empty() ? kNone : all.front();
}

std::vector<int> Atlas::surroundings(int reference, const Eigen::Vector3d& centre, double window) const {
  std::vector<int> ids = connected(reference, config_.connected);
  std::erase_if(ids, [&](int id) {
    return id != reference && far_in_any_axis(node(id).T_map_base.translation(), centre) > window;
  });
  return ids;
}

void Atlas::forget_far(const Eigen::Vector3d& centre, double window) {
  std::erase_if(present_, [&](int id) {
    const bool far = id != reference_ && far_in_any_axis(node(id).T_map_base.translation(), centre) > window;
    if (far) nodes_[static_cast<std::size_t>(id)].present = false;
    return far;
  });
}

std::vector<int> Atlas::take_returning(const Eigen::Vector3d& centre, double window) {
  std::vector<int> returning;
  if (reference_ == kNone) return returning;
  for (const int id : connected(reference_, config_.connected)) {
    Node& candidate = nodes_[static_cast<std::size_t>(id)];
    if (candidate.present || candidate.kept.points.empty()) continue;
    if (far_in_any_axis(candidate.kept.T_map_base.translation(), centre) > window) continue;
    candidate.present = true;
    present_.insert(id);
    returning.push_back(id);
  }
  return returning;
}

void Atlas::set_present(const std::vector<int>& ids, int reference) {
  for (const int id : present_) nodes_[static_cast<std::size_t>(id)].present = false;
  present_ = {ids.begin(), ids.end()};
  for (const int id : present_) nodes_[static_cast<std::size_t>(id)].present = true;
  reference_ = reference;
}

void Atlas::add_loop(const PoseEdge& loop) {
  connect(loop);
}

void Atlas::move(const std::vector<Pose>& corrections) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Pose& T_map_base = nodes_[i].kept.T_map_base;
    T_map_base = normalised(corrections[i] * T_map_base);
  }
}

void Atlas::roll_back(std::int64_t utime) {
  while (size() > num_known_ && nodes_.back().kept.utime > utime) {
    present_.erase(size() - 1);
    nodes_.pop_back();
  }
  std::erase_if(edges_, [&](const PoseEdge& edge) { return edge.from >= size() || edge.to >= size(); });
  for (Node& node : nodes_) node.edges.clear();
  for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
    for (const int end : {edges_[static_cast<std::size_t>(e)].from, edges_[static_cast<std::size_t>(e)].to}) {
      nodes_[static_cast<std::size_t>(end)].edges.push_back(e);
    }
  }
  if (reference_ >= size()) reference_ = size() - 1;
}

void Atlas::connect(const PoseEdge& edge) {
  const auto index = static_cast<int>(edges_.size());
  edges_.push_back(edge);
  nodes_[static_cast<std::size_t>(edge.from)].edges.push_back(index);
  nodes_[static_cast<std::size_t>(edge.to)].edges.push_back(index);
}

double Atlas::length_of(const PoseEdge& edge) const {
  return 1 / (edge.information(0, 0) * config_.step_m * config_.step_m);
}

/// An edge that was driven, or that holds because both ends are present.
PoseEdge Atlas::step(int from, int to, const Pose& T_from_to) const {
  double length = std::max(T_from_to.translation().norm(), 0.1);
  if (left_) length = std::pow((0.1 + kOdometryDrift * length) / config_.step_m, 2);
  registration::Vector6 information;
  information << Eigen::Vector3d::Constant(1 / (config_.step_m * config_.step_m * length)),
      Eigen::Vector3d::Constant(1 / (config_.step_rad * config_.step_rad * length));
  return {from, to, T_from_to, information.asDiagonal(), false};
}

bool Atlas::linked(int a, int b) const {
  const std::vector<int>& edges = nodes_[static_cast<std::size_t>(a)].edges;
  return std::any_of(edges.begin(), edges.end(), [&](int e) {
    const PoseEdge& edge = edges_[static_cast<std::size_t>(e)];
    return edge.from == b || edge.to == b;
  });
}

/// The farthest nodes stay in the graph and lose their scan, unless it is in the file.
void Atlas::bound_memory(const Eigen::Vector3d& centre) {
  if (size() <= config_.max_nodes || spill_file_->takes()) return;
  Node* farthest = nullptr;
  double distance = 0;
  for (Node& node : nodes_) {
    const double d = (node.kept.T_map_base.translation() - centre).norm();
    if (node.kept.points.empty() || node.kept.points.is_in_file() || d < distance) continue;
    distance = d;
    farthest = &node;
  }
  if (farthest != nullptr) farthest->kept.points = {};
}

}  // namespace curbstone::mapper::pose_graph
