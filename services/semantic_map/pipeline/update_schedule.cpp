#include "services/semantic_map/pipeline/update_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace curbstone::semantic_map::pipeline {

namespace {

constexpr std::int64_t kTick = 20'000;               // us: what work_per_tick is of
constexpr std::int64_t kSavedWork = 50'000;          // us
constexpr double kLargeShare = 0.3;                  // new points of a tile, from which its curbs are searched at once
constexpr std::int64_t kPatience = 150'000;          // us after which they are searched, however few there are
constexpr std::int64_t kSettlePatience = 1'000'000;  // us that a stale step may wait for new points of its tile
constexpr double kSettleShare = 0.10;                // of the work: tiles with new points never end

}  // namespace

void UpdateSchedule::voted(const VotedChange& change, std::int64_t now) {
  Pending& pending = pending_.try_emplace(change.key, Pending{now, change.points_before, 0, true}).first->second;
  pending.points = change.points;
  if (std::exchange(pending.is_shown, false)) unshown_.push_back(change.key);
}

std::optional<TileWork> UpdateSchedule::next_to_show() {
  while (!unshown_.empty()) {
    const TileKey key = unshown_.front();
    unshown_.pop_front();
    const auto pending = pending_.find(key);
    if (pending == pending_.end() || std::exchange(pending->second.is_shown, true)) continue;  // was brought up to date
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

void UpdateSchedule::spent(double cost) {
  budget_ -= cost;
  settling_owed_ = settles_ ? std::max(settling_owed_ - (1 - kSettleShare) * cost, -1.0)
                            : std::min(settling_owed_ + kSettleShare * cost, 1.0);
}

/// What may be computed by now: work_per_tick each 20 ms, of which no more is saved up than a revolution's time.
void UpdateSchedule::earn_work(std::int64_t now) {
  const auto elapsed = static_cast<double>(std::clamp<std::int64_t>(now - earned_at_, 0, kSavedWork));
  earned_at_ = now;
  const double rate = work_per_tick_ / static_cast<double>(kTick);
  budget_ = std::min(budget_ + rate * elapsed, rate * kSavedWork);
}

/// A tile with points of its own that are new: the nearest of those that are new to a good part, or else the one that
/// has waited for longest.
std::optional<TileWork> UpdateSchedule::take_pending(const Eigen::Vector2d& vehicle, std::int64_t now) {
  std::optional<std::tuple<bool, double, TileKey>> first;
  for (const auto& [key, pending] : pending_) {
    const auto before = static_cast<double>(pending.points_before);
    const bool is_large = static_cast<double>(pending.points) * (1 - kLargeShare) >= before;
    if (!is_large && std::abs(now - pending.since) < kPatience) continue;
    const double order =
        is_large ? squared_distance(key, vehicle.x(), vehicle.y()) : static_cast<double>(pending.since);
    const std::tuple due(!is_large, order, key);
    if (!first || due < *first) first = due;
  }
  if (!first) return std::nullopt;
  const TileKey key = std::get<TileKey>(*first);
  pending_.erase(key);
  return TileWork{TileWork::Kind::kUpdate, key};
}

/// Whether something has been stale for long.
bool UpdateSchedule::is_settling_due(const Backlog& backlog, std::int64_t now) {
  if (!turns_.empty() && now < turns_.back().first) turns_.clear();  // a clock that jumps
  if (turns_.empty() || now - turns_.back().first >= kTick) turns_.emplace_back(now, backlog.turn);
  while (turns_.size() > 1 && now - turns_[1].first >= kSettlePatience) turns_.pop_front();
  return now - turns_.front().first >= kSettlePatience && backlog.oldest <= turns_.front().second;
}

}  // namespace curbstone::semantic_map::pipeline
