#include "services/localizer/search/global_localizer.hpp"

#include "services/localizer/tracking/pose_on_ground.hpp"

namespace curbstone::localizer::search {
namespace {

constexpr std::size_t kMinRevolutions = 10;    // of a local scan,
constexpr double kMinCollected = 3.0;          // m: structures hidden from one place are visible from another
constexpr std::size_t kMinPlaces = 20;         // of a plan, to tell one place from another
constexpr std::int64_t kLookups = 10'000'000;  // of a search in one revolution: some 10 ms
constexpr double kMaxDriven = 30.0;            // m with several hypotheses; then the map is searched again

/// The belief for a candidate at the anchor, moved on by odometry since; on the map's ground, with roll and pitch from
/// odometry.
tracking::PoseBelief belief_at(const Candidate& candidate, const Pose& T_odom_anchor, const Pose& T_odom_base,
                               fields::SavedMap& map) {
  const double turned = candidate.yaw - roll_pitch_yaw(T_odom_anchor.linear()).z();
  const Eigen::Vector2d way =
      Eigen::Rotation2Dd(turned) * (T_odom_base.translation() - T_odom_anchor.translation()).head<2>();
  const double yaw = roll_pitch_yaw(T_odom_base.linear()).z() + turned;
  tracking::PoseBelief belief;
  belief.T_map_base =
      tracking::pose_on_ground(candidate.x + way.x(), candidate.y + way.y(), yaw, T_odom_base.linear(), map);
  tracking::Vector6 sigma;
  sigma << 0.25, 0.25, 0.1, 0.02, 0.02, 0.02;
  belief.covariance = sigma.cwiseAbs2().asDiagonal();
  return belief;
}

}  // namespace

std::optional<tracking::PoseBelief> GlobalLocalizer::process(const std::vector<Eigen::Vector3d>& points,
                                                             const Pose& T_odom_base, const tracking::Motion& motion,
                                                             fields::SavedMap& map) {
  switch (state_) {
    case State::kCollecting:
      collect(points, T_odom_base, map);
      break;
    case State::kSearching:
      search(T_odom_base, map);
      break;
    case State::kDriving:
      hypotheses_.update(points, motion, map);
      if (hypotheses_.converged()) return hypotheses_.alive().front().belief;
      if (hypotheses_.alive().empty() || hypotheses_.driven() > kMaxDriven) restart();
      break;
  }
  return std::nullopt;
}

void GlobalLocalizer::restart() {
  state_ = State::kCollecting;
  scan_.clear();
  search_.reset();
}

const Hypothesis* GlobalLocalizer::best() const {
  return state_ == State::kDriving && !hypotheses_.alive().empty() ? &hypotheses_.alive().front() : nullptr;
}

void GlobalLocalizer::collect(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base,
                              const fields::SavedMap& map) {
  scan_.add(points, T_odom_base);
  const bool seen_enough = scan_.revolutions() >= kMinRevolutions && scan_.driven() >= kMinCollected;
  if (!seen_enough && scan_.revolutions() < LocalScan::kMaxRevolutions) return;
  const auto plan = scan_.plan(T_odom_base, SearchRegion::kSight, MapSearch::kMaxPlaces);
  scan_.clear();
  if (plan.size() < kMinPlaces) return;
  T_odom_anchor_ = T_odom_base;
  search_.emplace(plan, map);
  state_ = State::kSearching;
}

void GlobalLocalizer::search(const Pose& T_odom_base, fields::SavedMap& map) {
  if (search_->advance(kLookups)) return;
  ++searches_;
  std::vector<tracking::PoseBelief> beliefs;
  for (const Candidate& one : search_->candidates())
    beliefs.push_back(belief_at(one, T_odom_anchor_, T_odom_base, map));
  search_.reset();
  hypotheses_.begin(std::move(beliefs));
  state_ = State::kDriving;
}

}  // namespace curbstone::localizer::search
