#include "services/localizer/search/hypotheses.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::localizer::search {
namespace {

constexpr double kNewest = 0.1;     // weight of the newest revolution in the averages
constexpr int kBeforeDropped = 5;   // revolutions: a fit takes a few to settle
constexpr double kRivals = 0.12;    // score: a hypothesis this far behind the best is dropped
constexpr double kSamePlace = 0.5;  // m
constexpr double kMinDriven = 3.0;  // m: a pose must fit from several places
constexpr double kHolds = 0.65;     // matched share

}  // namespace

void Hypotheses::begin(std::vector<tracking::PoseBelief> beliefs) {
  alive_.clear();
  for (tracking::PoseBelief& belief : beliefs) alive_.push_back({std::move(belief), {}, 0, 0});
  driven_ = 0;
  revolutions_ = 0;
}

void Hypotheses::update(const std::vector<Eigen::Vector3d>& points, const tracking::Motion& motion,
                        fields::SavedMap& map) {
  driven_ += motion.T_last_base.translation().norm();
  ++revolutions_;
  const tracking::ThinnedScan scan{points};
  for (Hypothesis& one : alive_) {
    one.belief = predicted(one.belief, motion, config_);
    one.fit = fit_pose(scan, one.belief, map, config_);
    const bool usable = is_finite(one.fit.belief.T_map_base) && one.fit.belief.covariance.allFinite();
    if (usable && one.fit.matched_share() > 0) one.belief = one.fit.belief;
  }
  weigh();
  drop();
}

void Hypotheses::weigh() {
  int uprights = 1, grounds = 1;
  for (const Hypothesis& one : alive_) {
    uprights = std::max(uprights, one.fit.uprights);
    grounds = std::max(grounds, one.fit.grounds);
  }
  const double newest = std::max(kNewest, 1.0 / revolutions_);
  for (Hypothesis& one : alive_) {
    const double score = 0.5 * one.fit.uprights_matched / uprights + 0.5 * one.fit.grounds_matched / grounds;
    one.score += newest * (score - one.score);
    one.matched_share += newest * (one.fit.matched_share() - one.matched_share);
  }
  std::stable_sort(alive_.begin(), alive_.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; });
}

void Hypotheses::drop() {
  std::vector<Hypothesis> kept;
  for (const Hypothesis& one : alive_) {
    const auto same = [&](const Hypothesis& other) {
      const Pose difference = other.belief.T_map_base.inverse() * one.belief.T_map_base;
      return difference.translation().head<2>().norm() < kSamePlace;
    };
    if (std::any_of(kept.begin(), kept.end(), same)) continue;
    const bool fails = one.matched_share < config_.min_match || one.score < alive_.front().score - kRivals;
    if (revolutions_ <= kBeforeDropped || !fails) kept.push_back(one);
  }
  alive_ = std::move(kept);
}

bool Hypotheses::converged() const {
  return alive_.size() == 1 && driven_ >= kMinDriven && alive_.front().matched_share >= kHolds;
}

bool Hypotheses::ambiguous() const {
  return alive_.size() > 1 && driven_ >= kMinDriven;
}

}  // namespace curbstone::localizer::search
