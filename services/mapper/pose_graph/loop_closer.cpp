#include "services/mapper/pose_graph/loop_closer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/pose_covariance.hpp"
#include "common/linear/decompositions.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

constexpr double kMinLoopLength = 150.0;  // m along the graph: shorter loops are not worth closing
constexpr double kTurn = 0.15;            // rad: largest drift of the heading
constexpr double kMinSigma = 0.02;  // m: the scans of nodes are downsampled, whatever covariance registration gives
constexpr double kMinTurn = 0.002;  // rad

registration::Matrix6 least_covariance() {
  registration::Vector6 least;
  least << Eigen::Vector3d::Constant(kMinSigma * kMinSigma), Eigen::Vector3d::Constant(kMinTurn * kMinTurn);
  return least.asDiagonal();
}

}  // namespace

/// The nearest node that drift may have displaced.
int LoopCloser::candidate(const Atlas& atlas, const Eigen::Vector3d& position) const {
  const std::vector<int> near = atlas.near(position, config_.max_search);
  if (std::none_of(near.begin(), near.end(), [&](int id) { return !atlas.present(id); })) return Atlas::kNone;
  const std::vector<int> connected = atlas.connected(atlas.reference(), kMinLoopLength);
  for (const int id : near) {
    if (atlas.present(id) || std::binary_search(connected.begin(), connected.end(), id)) continue;
    const double since = atlas.driven(atlas.reference()) - atlas.driven(id);
    const double distance = (atlas.node(id).T_map_base.translation() - position).head<2>().norm();
    if (distance <= config_.search + config_.search_drift * std::abs(since)) return id;
  }
  return Atlas::kNone;
}

std::optional<LoopClosure> LoopCloser::search(const Atlas& atlas, const Relocalizer& relocalizer,
                                              const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) {
  const Eigen::Vector3d position = T_map_base.translation();
  if (last_position_) travelled_ += (position - *last_position_).norm();
  last_position_ = position;
  if (!config_.close || travelled_ - last_look_ < config_.look_every) return std::nullopt;
  last_look_ = travelled_;
  const int node = candidate(atlas, position);
  if (node == Atlas::kNone) return std::nullopt;
  counters_.add("loops.looked");
  const double since = std::abs(atlas.driven(atlas.reference()) - atlas.driven(node));
  const double radius = std::min(config_.search + config_.search_drift * since, config_.max_search);
  const auto match = relocalizer.find_at(atlas, node, points, T_map_base, radius, kTurn);
  if (!match) return std::nullopt;
  counters_.add("loops.seen");
  const Pose correction = match->T_map_base * T_map_base.inverse();
  const std::optional<Seen> before = std::exchange(seen_, Seen{correction, travelled_});
  if (!before || travelled_ - before->travelled > config_.within) return std::nullopt;
  const Pose change = (before->correction * T_map_base).inverse() * match->T_map_base;
  if (change.translation().norm() > config_.agree_m || angle_of(change) > config_.agree_rad) {
    counters_.add("loops.disagreed");
    return std::nullopt;
  }
  seen_.reset();
  return LoopClosure{node, atlas.node(node).T_map_base.inverse() * match->T_map_base, match->covariance};
}

/// Older loops that were rejected as outliers do not count against the new one.
bool LoopCloser::bends_too_far(const std::vector<PoseEdge>& edges, const std::vector<double>& sigma) const {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const bool counts = !edges[e].closes_loop || e + 1 == edges.size();
    if (counts && !(sigma[e] < config_.max_sigma)) return true;
  }
  return false;
}

std::optional<LoopCorrection> LoopCloser::solve(const Atlas& atlas, const LoopClosure& closure,
                                                const Pose& T_map_base) const {
  const int reference = atlas.reference();
  const Pose T_base_reference = T_map_base.inverse() * atlas.node(reference).T_map_base;
  LoopCorrection correction;
  correction.loop = {closure.node, reference, closure.T_node_base * T_base_reference,
                     inverse(covariance_of_increment(T_base_reference, closure.covariance, least_covariance())), true};
  std::vector<PoseEdge> edges = atlas.edges();
  edges.push_back(correction.loop);
  const std::vector<Pose> before = atlas.poses();
  std::vector<bool> fixed(before.size(), false);
  for (int id = 0; id < std::max(atlas.num_known(), 1); ++id) fixed[static_cast<std::size_t>(id)] = true;
  const PoseGraphResult solved = optimise_pose_graph(before, fixed, edges);
  if (!solved.converged || bends_too_far(edges, solved.edge_sigma)) return std::nullopt;
  for (std::size_t i = 0; i < before.size(); ++i) {
    correction.T_new_old.push_back(normalised(solved.poses[i] * before[i].inverse()));
  }
  return correction;
}

bool LoopCloser::is_significant(const LoopCorrection& correction, const Atlas& atlas) const {
  for (int id = 0; id < atlas.size(); ++id) {
    const Eigen::Vector3d& was = atlas.node(id).T_map_base.translation();
    if ((correction.T_new_old[static_cast<std::size_t>(id)] * was - was).norm() > config_.rearrange_m) return true;
  }
  return false;
}

}  // namespace curbstone::mapper::pose_graph
