#include "services/localizer/search/map_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::localizer::search {
namespace {

constexpr int kTurns = 320;  // 0.02 rad apart: half of that moves a point at 30 m by 0.3 m
constexpr int kTop = SearchRegion::kLevels - 1;
constexpr double kMinScore = 0.5;                       // score: the plan fits better than this at its true place
constexpr double kBehind = 0.2;                         // score: a candidate this far behind the best is no rival
constexpr double kMatchesApart = 1.5;                   // m, between distinct candidates
constexpr double kMatchesTurned = 0.1;                  // rad
constexpr std::int64_t kLookupsInRegion = 120'000'000;  // a bound on time: the rest of the region is skipped
constexpr std::int64_t kLookupsToBuild = 10'000'000;    // a region's lattices take as long as this many look-ups

double yaw_of(int turn) {
  return turn * (2 * std::numbers::pi / kTurns);
}

bool same_place(const Candidate& a, const Candidate& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < kMatchesApart &&
         std::abs(std::remainder(a.yaw - b.yaw, 2 * std::numbers::pi)) < kMatchesTurned;
}

}  // namespace

MapSearch::MapSearch(const std::vector<Eigen::Vector2d>& plan, const fields::SavedMap& map)
    : map_(map), full_(255 * static_cast<int>(plan.size())) {
  if (plan.empty()) return;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::Rotation2Dd R(yaw_of(turn));
    std::vector<std::int32_t> offsets;
    for (const Eigen::Vector2d& p : plan) {
      const Eigen::Vector2d q = R * p / SearchRegion::kCell;
      offsets.push_back(static_cast<std::int32_t>(std::lround(q.y()) * SearchRegion::side() + std::lround(q.x())));
    }
    offsets_.push_back(std::move(offsets));
  }
  for (const TileKey key : map.keys()) regions_.push_back(SearchRegion::region_of(key));
  std::sort(regions_.begin(), regions_.end());
  regions_.erase(std::unique(regions_.begin(), regions_.end()), regions_.end());
}

bool MapSearch::advance(std::int64_t lookups) {
  const std::int64_t until = lookups_ + lookups;
  while (!done() && lookups_ < until) {
    if (!region_) {
      enter_next_region();
    } else if (next_row_ < SearchRegion::wide()) {
      push_row();
    } else if (queue_.empty() || queue_.top().sum < least() || here_.size() >= kMaxCandidates ||
               lookups_here_ > kLookupsInRegion) {
      leave_region();
    } else {
      const Branch branch = queue_.top();
      queue_.pop();
      follow(branch);
    }
  }
  return !done();
}

void MapSearch::enter_next_region() {
  region_.emplace(regions_[next_region_++], map_);
  next_row_ = next_turn_ = 0;
  lookups_here_ = 0;
  lookups_ += kLookupsToBuild;
}

void MapSearch::leave_region() {
  found_.insert(found_.end(), here_.begin(), here_.end());
  here_.clear();
  queue_ = {};
  region_.reset();
}

/// Adds the next row of branches of the coarsest level, at one heading.
void MapSearch::push_row() {
  for (int x = 0; x < SearchRegion::wide(); x += 1 << kTop) push(kTop, next_turn_, x, next_row_);
  next_turn_ = (next_turn_ + 1) % kTurns;
  if (next_turn_ == 0) next_row_ += 1 << kTop;
}

int MapSearch::least() const {
  return static_cast<int>(std::max(kMinScore, best_ - kBehind) * full_);
}

void MapSearch::push(int level, int turn, int x, int y) {
  if (x >= SearchRegion::wide() || y >= SearchRegion::wide() || !region_->drivable(level, x, y)) return;
  constexpr std::ptrdiff_t kAtOnce = 16;
  const std::uint8_t* values = region_->upright(level, x, y);
  const std::vector<std::int32_t>& offsets = offsets_[static_cast<std::size_t>(turn)];
  // The branch is dropped as soon as too much is missing.
  int may_miss = full_ - least();
  auto offset = offsets.begin();
  while (offset != offsets.end() && may_miss >= 0) {
    const auto until = offset + std::min(kAtOnce, offsets.end() - offset);
    for (; offset != until; ++offset) may_miss -= 255 - values[*offset];
  }
  const std::int64_t looked_up = offset - offsets.begin();
  lookups_ += looked_up;
  lookups_here_ += looked_up;
  if (may_miss >= 0) queue_.push({least() + may_miss, level, turn, x, y});
}

void MapSearch::follow(const Branch& branch) {
  if (covered(branch)) return;
  if (branch.level == 0) {
    const Eigen::Vector2d at = region_->middle(branch.x, branch.y);
    here_.push_back({at.x(), at.y(), yaw_of(branch.turn), static_cast<double>(branch.sum) / full_});
    best_ = std::max(best_, here_.back().score);
    return;
  }
  const int half = 1 << (branch.level - 1);
  for (const int y : {branch.y, branch.y + half}) {
    for (const int x : {branch.x, branch.x + half}) push(branch.level - 1, branch.turn, x, y);
  }
}

/// Whether every pose that the branch may lead to is close to a known candidate.
bool MapSearch::covered(const Branch& branch) const {
  const int last = (1 << branch.level) - 1;
  const Eigen::Vector2d low = region_->middle(branch.x, branch.y);
  const Eigen::Vector2d high = region_->middle(branch.x + last, branch.y + last);
  return std::any_of(here_.begin(), here_.end(), [&](const Candidate& known) {
    const Eigen::Vector2d at(known.x, known.y);
    const Eigen::Vector2d farthest = (low - at).cwiseAbs().cwiseMax((high - at).cwiseAbs());
    const double turned = std::remainder(yaw_of(branch.turn) - known.yaw, 2 * std::numbers::pi);
    return farthest.norm() < kMatchesApart && std::abs(turned) < kMatchesTurned;
  });
}

std::vector<Candidate> MapSearch::candidates() const {
  std::vector<Candidate> all = found_;
  all.insert(all.end(), here_.begin(), here_.end());
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Candidate> apart;
  for (const Candidate& one : all) {
    if (apart.size() >= kMaxCandidates || one.score < best_ - kBehind) break;
    const auto same = [&](const Candidate& other) { return same_place(one, other); };
    if (std::none_of(apart.begin(), apart.end(), same)) apart.push_back(one);
  }
  return apart;
}

}  // namespace curbstone::localizer::search
