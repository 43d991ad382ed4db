#include <algorithm>
#include <cmath>

#include "common/time/has_passed.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"

/// @file
/// TensorVotingNode: tiles far from the vehicle.

namespace curbstone::tensor_voting::worker {

namespace {

constexpr double kRoom = 0.9;                     // of max_points, above which nothing is asked for again
constexpr std::int64_t kFarPatience = 5'000'000;  // us: further points of a far tile may still arrive

}  // namespace

double TensorVotingNode::distance(TileKey key) const {
  return std::sqrt(squared_distance(key, x_, y_));
}

bool TensorVotingNode::is_unpublished(TileKey key) const {
  if (schedule_.has_forgotten()) return false;
  if (schedule_.published_revision(key) == 0 || map_.points().find(key) != nullptr) return true;
  bool any = false;
  for_each_around(key, [&](TileKey around) {
    any = any || (map_.points().find(around) != nullptr && schedule_.published_revision(around) == 0);
  });
  return any;
}

bool TensorVotingNode::has_neighbours(TileKey key) const {
  bool all = true;
  for_each_around(key, [&](TileKey around) {
    all = all && (map_.points().find(around) != nullptr || schedule_.published_revision(around) == 0);
  });
  return all;
}

/// Whether a far tile may be released: neither it nor a neighbour is still to be published, and no more points of it
/// are expected.
bool TensorVotingNode::may_release(TileKey key) const {
  const auto heard = far_heard_.find(key);
  if (heard != far_heard_.end() && (!has_passed(kFarPatience, heard->second, now_) || follower_.is_behind(key)))
    return false;
  bool waits = false;
  for_each_around(key, [&](TileKey around) {
    const bool is_new = map_.points().find(around) != nullptr && schedule_.published_revision(around) == 0;
    waits = waits || is_new || schedule_.is_pending(around);
  });
  return !waits;
}

/// Discards the digests of a sleeping tile's published sums: if it wakes, its next delta contains all tensors.
void TensorVotingNode::forget_sums(TileKey key) {
  const auto base = bases_.find(key);
  if (base != bases_.end()) std::vector<VotedBase::Scale>().swap(base->second.scales);
}

/// Reviews tiles that are far, or near again. Then releases those that have fallen behind: a tile that was scheduled by
/// its review has the votes of its neighbours, so they must stay until it is published.
void TensorVotingNode::follow_vehicle() {
  for (const auto& [key, tile] : map_.points().tiles()) {
    if (map_.is_asleep(key)) forget_sums(key);
    if (!is_near(key) || distance(key) > config_.keep_radius - 2 * kRim) review(key);
  }
  std::vector<TileKey> far;
  for (const auto& [key, tile] : map_.points().tiles()) {
    if (!is_near(key) && may_release(key)) far.push_back(key);
  }
  for (const TileKey key : far) {
    map_.erase(key);
    follower_.forget(key);
    catalog_.remove(key);
    bases_.erase(key);
    far_heard_.erase(key);
    full_.erase(key);
    counters_.add("tiles_let_go");
  }
  schedule_.forget_far(x_, y_, config_.keep_radius);
}

/// The records up to `version` of a tile do not fit into max_points. They would come again each second, for nothing.
void TensorVotingNode::mute(TileKey key, std::int32_t version) {
  std::int32_t& muted = full_[key];
  muted = std::max(muted, version);
  follower_.set_have(key, muted);
}

/// Asks for them once there is room again: the vehicle has gone on, or the mapper has removed points.
void TensorVotingNode::unmute() {
  if (full_.empty() || static_cast<double>(map_.points().num_points()) > kRoom * config_.max_points) return;
  for (const auto& [key, version] : full_) {
    if (!is_near(key)) {
      follower_.forget(key);
      continue;
    }
    const PointTile* const tile = map_.points().find(key);
    follower_.set_have(key, tile == nullptr ? 0 : tile->records);
    follower_.lacks(key, version);
  }
  full_.clear();
}

}  // namespace curbstone::tensor_voting::worker
