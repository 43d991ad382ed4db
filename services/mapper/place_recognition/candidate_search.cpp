#include "services/mapper/place_recognition/candidate_search.hpp"

#include <algorithm>
#include <cmath>

#include "services/mapper/place_recognition/branch_and_bound.hpp"
#include "services/mapper/place_recognition/visibility_check.hpp"
#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::place_recognition {
namespace {

constexpr double kBeyond = 25.0;  // m around the possible positions: nodes within it show what the vehicle sees
constexpr double kMaxSearchRadius = 50.0;  // m
constexpr std::size_t kMaxNodes = 30;      // that are taken into account
constexpr double kNodesApart = 1.5;        // m: a node nearer to another adds nothing
constexpr std::size_t kSightNodes = 3;     // from which visibility is checked
constexpr double kThinned = 0.3;           // m: one upright point counts per cube of this size
constexpr float kScanReach = 60.0F;        // m, of the scans of nodes
constexpr float kGroundReach = 20.0F;      // m: ground within it determines the height
constexpr float kGroundSpread = 0.25F;     // m, spread of consistent ground: a degree of tilt, 10 m away
constexpr std::size_t kMinStanding = 60;   // points; fewer are no evidence
constexpr std::size_t kMinGround = 10;     // places of the ground

using Cloud = std::vector<Eigen::Vector3f>;

const auto kAsIs = [](const Eigen::Vector3f& p) { return p; };
const auto kOfScan = [](const scan::LidarPoint& p) { return p.position; };
const auto kOfNode = [](const scan::KeyframePoint& p) { return scan::unpack(p); };

template <class Points, class Position>
Cloud transformed(const Pose& T, const Points& points, const Position& position) {
  const Eigen::Isometry3f t = T.cast<float>();
  Cloud out;
  out.reserve(points.size());
  for (const auto& point : points) out.push_back(t * position(point));
  return out;
}

Cloud one_a_cube(const Cloud& points) {
  voxels::FlatIndex taken(points.size());
  Cloud out;
  for (const Eigen::Vector3f& p : points) {
    if (taken.find_or_insert(voxels::voxel_key(voxels::voxel_of(p, 1 / kThinned)), 0) == voxels::FlatIndex::kNone)
      out.push_back(p);
  }
  return out;
}

/// The part of an attitude that gravity determines: roll and pitch, without yaw.
Pose level_from_base(const Pose& T_map_base) {
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_map_base.linear());
  Pose T = Pose::Identity();
  T.linear() = rotation_from_rpy(rpy.x(), rpy.y(), 0);
  return T;
}

LowestPoints lowest_of(const Cloud& level, double reach) {
  LowestPoints lowest(static_cast<float>(reach));
  for (const Eigen::Vector3f& p : level) lowest.add(p);
  return lowest;
}

Pose from(const Eigen::Vector3d& position) {
  return Pose(Eigen::Translation3d(position));
}

PlaceGuess bounded(PlaceGuess guess) {
  guess.reach = guess.reach > 0 ? std::min(guess.reach, kMaxSearchRadius) : 0;
  return guess;
}

std::vector<scan::Keyframe> near(const std::vector<const scan::Keyframe*>& nodes, const PlaceGuess& guess) {
  std::vector<std::pair<double, const scan::Keyframe*>> found;
  for (const scan::Keyframe* node : nodes) {
    const Eigen::Vector3d off = node->T_map_base.translation() - guess.T_map_base.translation();
    const double distance = off.head<2>().norm();
    if (distance < guess.reach + kBeyond && std::abs(off.z()) < guess.reach + kBeyond)
      found.emplace_back(distance, node);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<scan::Keyframe> out;
  for (const auto& [distance, node] : found) {
    if (out.size() == kMaxNodes) break;
    const bool new_to_us = std::all_of(out.begin(), out.end(), [&, n = node](const scan::Keyframe& other) {
      return (other.T_map_base.translation() - n->T_map_base.translation()).norm() > kNodesApart;
    });
    if (new_to_us) out.push_back({node->utime, node->T_map_base, node->points.in_memory()});
  }
  return out;
}

/// The nodes' points in map axes, relative to the guess's position, where floats are precise enough.
Cloud points_about(const std::vector<scan::Keyframe>& nodes, const Eigen::Vector3d& position) {
  Cloud out;
  for (const scan::Keyframe& node : nodes) {
    const Cloud here = transformed(from(-position) * node.T_map_base, *node.points.read(), kOfNode);
    out.insert(out.end(), here.begin(), here.end());
  }
  return out;
}

/// How far a scan must rise for its ground to coincide with the map's, by the majority of its square metres: where a
/// car hides the ground, the car is the lowest.
std::optional<double> rise(const Cloud& level, const LowestPoints& ground, const Pose& T_local_level,
                           const LowestPoints& map) {
  const Eigen::Isometry3f T = T_local_level.cast<float>();
  std::vector<float> rises;
  for (const Eigen::Vector3f& p : level) {
    if (p.head<2>().norm() > kGroundReach || !(p.z() <= ground.at(p))) continue;
    const Eigen::Vector3f q = T * p;
    const float z = map.at(q);
    if (std::isfinite(z)) rises.push_back(z - q.z());
  }
  if (rises.size() < kMinGround) return std::nullopt;
  std::sort(rises.begin(), rises.end());
  std::size_t most = 0, begin = 0;
  for (std::size_t i = 0, j = 0; j < rises.size(); ++j) {
    while (rises[j] - rises[i] > kGroundSpread) ++i;
    if (j - i > most) most = j - i, begin = i;
  }
  return static_cast<double>(rises[begin + most / 2]);
}

}  // namespace

CandidateSearch::CandidateSearch(const std::vector<const scan::Keyframe*>& nodes, const PlaceGuess& guess,
                                 const config::IcpConfig& config, const Eigen::Vector3d& lidar)
    : guess_(bounded(guess)),
      config_(config),
      lidar_(lidar),
      nodes_(near(nodes, guess_)),
      lowest_(static_cast<float>(lattice_reach(guess_.reach))) {
  const Cloud points = points_about(nodes_, guess_.T_map_base.translation());
  for (const Eigen::Vector3f& p : points) lowest_.add(p);
  standing_ = one_a_cube(upright(points, lowest_));
  grids_.emplace(standing_, lattice_reach(guess_.reach));
}

std::vector<PlaceHypothesis> CandidateSearch::hypotheses(const std::vector<scan::LidarPoint>& points, int most) const {
  if (nodes_.empty()) return {};
  const Pose T_level_base = level_from_base(guess_.T_map_base);
  const Cloud level = transformed(T_level_base, points, kOfScan);
  const LowestPoints ground = lowest_of(level, kScanReach);
  const Cloud standing = one_a_cube(upright(level, ground));
  if (standing.size() < kMinStanding) return {};
  const SearchWindow range{guess_.reach, roll_pitch_yaw(guess_.T_map_base.linear()).z(), guess_.turn};
  std::vector<PlaceHypothesis> out;
  for (const PlanarPose& found : branch_and_bound(*grids_, standing, range, most)) {
    Pose T_local_level = from({found.x, found.y, 0}) * Eigen::AngleAxisd(found.yaw, Eigen::Vector3d::UnitZ());
    const std::optional<double> up = rise(level, ground, T_local_level, lowest_);
    if (!up) continue;
    T_local_level.translation().z() = *up;
    out.push_back({normalised(from(guess_.T_map_base.translation()) * T_local_level * T_level_base), found.score});
  }
  return out;
}

PlaceMatch CandidateSearch::refine(const std::vector<scan::LidarPoint>& points, const PlaceHypothesis& hypothesis) {
  if (!registration_) {
    registration_ = std::make_unique<registration::IcpRegistration>(config_, lidar_);
    for (const scan::Keyframe& node : nodes_) registration_->insert_keyframe(node);
  }
  registration::PosePrior prior;
  prior.T_map_base = hypothesis.T_map_base;
  registration::Vector6 sigma;  // loose; the lattice's step and an accelerometer's level are more accurate
  sigma << 1.0, 1.0, 0.5, 0.02, 0.02, 0.05;
  prior.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  prior.reach = 0.5;
  PlaceMatch match;
  match.registration = registration_->align(points, prior);
  if (!match.registration.converged) {
    prior.T_map_base = match.registration.T_map_base;
    match.registration = registration_->align(points, prior);
  }
  const Pose& T = match.registration.T_map_base;
  const Pose T_level_base = level_from_base(T);
  const Cloud level = transformed(T_level_base, points, kOfScan);
  const LowestPoints ground = lowest_of(level, kScanReach);
  const Cloud standing = one_a_cube(upright(level, ground));
  const Pose T_map_level = T * T_level_base.inverse();
  const Pose T_local_level = from(-guess_.T_map_base.translation()) * T_map_level;
  match.score = score_at(standing, T_local_level);
  match.rise = rise(level, ground, T_local_level, lowest_).value_or(kMaxSearchRadius);
  match.conflict = conflict_at(points, transformed(T_map_level, standing, kAsIs), T);
  return match;
}

double CandidateSearch::score_at(const Cloud& standing, const Pose& T_local_level) const {
  double sum = 0;
  for (const Eigen::Vector3f& p : transformed(T_local_level, standing, kAsIs)) sum += grids_->at(p);
  return sum / static_cast<double>(std::max<std::size_t>(standing.size(), 1));
}

/// Upright points of the map against the scan's rays, and of the scan against the rays of the nearest nodes.
double CandidateSearch::conflict_at(const std::vector<scan::LidarPoint>& points, const Cloud& standing,
                                    const Pose& T_map_base) const {
  const Pose T_lidar_base = from(-lidar_);
  const Eigen::Vector3d& position = T_map_base.translation();
  const Pose T_lidar_local = T_lidar_base * T_map_base.inverse() * from(guess_.T_map_base.translation());
  VisibilityCount count =
      VisibilityCheck(transformed(T_lidar_base, points, kOfScan)).check(transformed(T_lidar_local, standing_, kAsIs));
  std::vector<scan::Keyframe> nearest = nodes_;
  std::stable_sort(nearest.begin(), nearest.end(), [&](const scan::Keyframe& a, const scan::Keyframe& b) {
    return (a.T_map_base.translation() - position).squaredNorm() <
           (b.T_map_base.translation() - position).squaredNorm();
  });
  nearest.resize(std::min(nearest.size(), kSightNodes));
  for (const scan::Keyframe& node : nearest) {
    const Pose T_node_map = T_lidar_base * node.T_map_base.inverse();
    count += VisibilityCheck(transformed(T_lidar_base, *node.points.read(), kOfNode))
                 .check(transformed(T_node_map, standing, kAsIs));
  }
  const int sighted = count.agree + count.conflict;
  return sighted > 0 ? static_cast<double>(count.conflict) / sighted : 1;
}

}  // namespace curbstone::mapper::place_recognition
