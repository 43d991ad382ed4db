#include "services/mapper/pose_graph/relocalizer.hpp"

#include <algorithm>
#include <numbers>

namespace curbstone::mapper::pose_graph {
namespace {

constexpr double kSurroundings = 60.0;     // m along the graph that one search covers
constexpr double kMinSearchRadius = 1.0;   // m, least and
constexpr double kMaxSearchRadius = 15.0;  // m, largest reach of a search about a guess
constexpr double kUnseenTurn = 0.3;        // rad: turn that the vehicle may have made unobserved,
constexpr auto kKnown = place_recognition::Known::kPart;
constexpr double kTurnPerMetre = 0.3;  // and rad more per m of possible motion

}  // namespace

std::optional<FoundPlace> Relocalizer::find_at(const Atlas& atlas, int node,
                                               const std::vector<scan::LidarPoint>& points, const Pose& guess,
                                               double reach, double turn, place_recognition::Known known) const {
  std::vector<const scan::Keyframe*> nodes;
  for (const int id : atlas.connected(node, kSurroundings)) nodes.push_back(&atlas.node(id));
  const auto match = place_recognition::verify_place(points, {guess, reach, turn}, nodes, config_, lidar_, known);
  if (!match) return std::nullopt;
  return FoundPlace{match->registration.T_map_base, match->registration.covariance, node};
}

std::optional<FoundPlace> Relocalizer::find(const Atlas& atlas, const std::vector<scan::LidarPoint>& points,
                                            const Pose& guess, double uncertainty) {
  const double reach = std::min(kMinSearchRadius + uncertainty, kMaxSearchRadius);
  const double turn = std::min(kUnseenTurn + kTurnPerMetre * uncertainty, std::numbers::pi);
  const std::vector<int> near = atlas.near(guess.translation(), reach + 10.0);
  if (!near.empty()) {
    if (const auto found = find_at(atlas, near.front(), points, guess, reach, turn, kKnown)) return found;
  }
  return needs_global_search(uncertainty) ? find_globally(atlas, points, guess) : std::nullopt;
}

bool Relocalizer::needs_global_search(double uncertainty) {
  return kMinSearchRadius + uncertainty > kMaxSearchRadius;
}

void Relocalizer::clear() {
  index_.clear();
  indexed_ = 0;
}

std::optional<FoundPlace> Relocalizer::find_globally(const Atlas& atlas, const std::vector<scan::LidarPoint>& points,
                                                     const Pose& guess) {
  for (; indexed_ < atlas.size(); ++indexed_) index_.add(indexed_, *atlas.node(indexed_).points.read());
  std::vector<const scan::Keyframe*> nodes;
  for (int id = 0; id < atlas.size(); ++id) nodes.push_back(&atlas.node(id));
  const auto match = place_recognition::verify_place(points, guess, index_, nodes, config_, lidar_, kKnown);
  if (!match) return std::nullopt;
  const Pose& T_map_base = match->registration.T_map_base;
  return FoundPlace{T_map_base, match->registration.covariance, atlas.near(T_map_base.translation(), 1e9).front()};
}

}  // namespace curbstone::mapper::pose_graph
