#include "services/semantic_map/pipeline/update_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace curbstone::semantic_map::pipeline {

namespace {

constexpr std::int64_t kTick = 20'000;       // us, the tick of work_per_tick
constexpr std::int64_t kSavedWork = 50'000;  // us of work that may be saved up: a revolution's time
constexpr double kLargeShare = 0.3;          // share of new points in a tile, from which its curbs are searched at once
constexpr std::int64_t kPatience = 150'000;  // us after which they are searched, however few there are
constexpr std::int64_t kSettlePatience = 1'000'000;  // us that a stale step may wait for new points of its tile
constexpr double kSettleShare = 0.10;                // of the work, because there are always tiles with new points
constexpr double kOld = 200'000;                     // us: after this wait a tile is twice as urgent
constexpr std::int64_t kOverdue = 1'000'000;         // us: tiles that have waited for longer go first
constexpr double kNear = 20;                         // m: at this distance a tile is half as urgent as at the vehicle
constexpr double kMeanUpdate = 1.7;                  // WorkResult::cost of a tile's update, on average in a town
constexpr double kMinUpdateCost = 0.5;               // added to the counted cost: no update is free

}  // namespace

void UpdateSchedule::voted(const VotedChange& change, std::int64_t now) {
  const auto [it, is_first] = pending_.try_emplace(change.key);
  Pending& pending = it->second;
  if (is_first) pending = {.since = now, .points_before = change.points_before, .is_shown = true};
  pending.points = change.points;
  pending.cost = change.update_cost;
  pending.num_steps += 1;
  pending.mean_step_at += (static_cast<double>(now - pending.since) - pending.mean_step_at) / pending.num_steps;
  if (std::exchange(pending.is_shown, false)) unshown_.push_back(change.key);
}

std::optional<TileWork> UpdateSchedule::next_to_show() {
  while (!unshown_.empty()) {
    const TileKey key = unshown_.front();
    unshown_.pop_front();
    const auto pending = pending_.find(key);
    if (pending == pending_.end() || std::exchange(pending->second.is_shown, true)) continue;  // updated since
    return TileWork{TileWork::Kind::kUpdateColumns, key};
  }
  return std::nullopt;
}

std::optional<TileWork> UpdateSchedule::next_work(const Eigen::Vector2d& vehicle, const Backlog& backlog,
                                                  std::int64_t now) {
  earn_work(now);
  if (budget_ <= 0) return std::nullopt;
  settles_ = is_settling_due(backlog, now);
  if (settles_ && settling_owed_ > 0) return TileWork{TileWork::Kind::kOldestStep};
  if (const auto work = take_pending(vehicle, now)) {
    settles_ = false;
    return work;
  }
  if (!settles_) return std::nullopt;
  return TileWork{TileWork::Kind::kOldestStep};
}

/// An update is charged half by its own cost and half by that of an average one. By its own cost alone, curbs would
/// become old where tiles are costly; by the average alone, cheap tiles would wait for costly ones.
void UpdateSchedule::spent(double cost) {
  if (!settles_) cost = 0.5 * (cost + kMeanUpdate);
  budget_ -= cost;
  settling_owed_ = settles_ ? std::max(settling_owed_ - (1 - kSettleShare) * cost, -1.0)
                            : std::min(settling_owed_ + kSettleShare * cost, 1.0);
}

/// Adds work_per_tick for each 20 ms to the budget, which saves up at most kSavedWork.
void UpdateSchedule::earn_work(std::int64_t now) {
  const auto elapsed = static_cast<double>(std::clamp<std::int64_t>(now - earned_at_, 0, kSavedWork));
  earned_at_ = now;
  const double rate = work_per_tick_ / static_cast<double>(kTick);
  budget_ = std::min(budget_ + rate * elapsed, rate * kSavedWork);
}

/// The total waiting time that an update of the tile would end, per unit of cost; more for tiles that have waited for
/// long. A tile that was never updated counts as cheap, because it is new.
double UpdateSchedule::urgency(const Pending& pending, double distance, std::int64_t now) {
  const auto waited = static_cast<double>(now - pending.since);
  const double saved = pending.num_steps * (waited - pending.mean_step_at) * (1 + waited / kOld);
  return std::max(saved, 0.0) / (pending.cost + kMinUpdateCost) / (1 + distance / kNear);
}

/// The most urgent of the tiles that are due: those of whose points a large share is new, or that have waited.
std::optional<TileWork> UpdateSchedule::take_pending(const Eigen::Vector2d& vehicle, std::int64_t now) {
  std::optional<std::tuple<std::int64_t, double, TileKey>> first;
  for (const auto& [key, pending] : pending_) {
    const auto before = static_cast<double>(pending.points_before);
    const bool is_large = static_cast<double>(pending.points) * (1 - kLargeShare) >= before;
    const std::int64_t waited = std::abs(now - pending.since);  // a clock may have jumped
    if (!is_large && waited < kPatience) continue;
    const double distance = std::sqrt(squared_distance(key, vehicle.x(), vehicle.y()));
    const bool is_overdue = waited >= kOverdue;
    const std::tuple due(is_overdue ? -waited : 0, -urgency(pending, distance, now), key);
    if (!first || due < *first) first = due;
  }
  if (!first) return std::nullopt;
  const TileKey key = std::get<TileKey>(*first);
  pending_.erase(key);
  return TileWork{TileWork::Kind::kUpdate, key};
}

/// Whether a step has been stale for kSettlePatience.
bool UpdateSchedule::is_settling_due(const Backlog& backlog, std::int64_t now) {
  if (!turns_.empty() && now < turns_.back().first) turns_.clear();  // a clock that jumps
  if (turns_.empty() || now - turns_.back().first >= kTick) turns_.emplace_back(now, backlog.turn);
  while (turns_.size() > 1 && now - turns_[1].first >= kSettlePatience) turns_.pop_front();
  return now - turns_.front().first >= kSettlePatience && backlog.oldest <= turns_.front().second;
}

}  // namespace curbstone::semantic_map::pipeline
