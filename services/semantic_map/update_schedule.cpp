#include "services/semantic_map/update_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace curbstone {

namespace {

constexpr std::int64_t kTick = 20'000;               // us: what work_per_tick is of
constexpr std::int64_t kSavedWork = 50'000;          // us
constexpr double kLargeShare = 0.3;                  // new points of a tile for which its curbs are looked for at once
constexpr std::int64_t kNewsPatience = 500'000;      // us after which they are looked for, however few there are
constexpr std::int64_t kSettlePatience = 1'000'000;  // us that what is stale may wait for news of its own

}  // namespace

UpdateSchedule::UpdateSchedule(double work_per_tick, TilePipeline& pipeline)
    : work_per_tick_(work_per_tick), pipeline_(pipeline) {}

void UpdateSchedule::changed(TileKey key, std::size_t points_before, std::int64_t now) {
  News& news = news_.try_emplace(key, News{now, points_before, true}).first->second;
  if (std::exchange(news.is_shown, false)) unshown_.push_back(key);
}

bool UpdateSchedule::work_on_one(const Eigen::Vector2d& vehicle, std::int64_t now) {
  earn_work(now);
  if (budget_ <= 0) return false;
  const double before = pipeline_.work();
  const bool worked = update_news(vehicle, now) || settle_stale(now);
  budget_ -= pipeline_.work() - before;
  return worked;
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
bool UpdateSchedule::update_news(const Eigen::Vector2d& vehicle, std::int64_t now) {
  std::optional<std::tuple<bool, double, TileKey>> first;
  for (const auto& [key, news] : news_) {
    const auto before = static_cast<double>(news.num_points);
    const bool is_large = static_cast<double>(pipeline_.voted(key)->points.size()) * (1 - kLargeShare) >= before;
    if (!is_large && std::abs(now - news.since) < kNewsPatience) continue;
    const double order = is_large ? squared_distance(key, vehicle.x(), vehicle.y()) : static_cast<double>(news.since);
    const std::tuple due(!is_large, order, key);
    if (!first || due < *first) first = due;
  }
  if (!first) return false;
  pipeline_.update(std::get<TileKey>(*first));
  news_.erase(std::get<TileKey>(*first));
  return true;
}

bool UpdateSchedule::show_one() {
  while (!unshown_.empty()) {
    const TileKey key = unshown_.front();
    unshown_.pop_front();
    const auto news = news_.find(key);
    if (news == news_.end() || std::exchange(news->second.is_shown, true)) continue;  // was brought up to date
    pipeline_.update_columns(key);
    return true;
  }
  return false;
}

/// What has been stale for longest, if that is long.
bool UpdateSchedule::settle_stale(std::int64_t now) {
  if (!turns_.empty() && now < turns_.back().first) turns_.clear();  // a clock that jumps
  if (turns_.empty() || now - turns_.back().first >= kTick) turns_.emplace_back(now, pipeline_.turn());
  while (turns_.size() > 1 && now - turns_[1].first >= kSettlePatience) turns_.pop_front();
  return now - turns_.front().first >= kSettlePatience && pipeline_.settle_one(turns_.front().second + 1);
}

}  // namespace curbstone
