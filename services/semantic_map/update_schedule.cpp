#include "services/semantic_map/update_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

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
  news_.try_emplace(key, News{now, points_before, false}).first->second.is_shown = false;
}

void UpdateSchedule::work(const Eigen::Vector2d& vehicle, std::int64_t now) {
  earn_work(now);
  update_news(vehicle, now);
  settle_stale(now);
}

/// What may be computed by now: work_per_tick each 20 ms, of which no more is saved up than a revolution's time.
void UpdateSchedule::earn_work(std::int64_t now) {
  const auto elapsed = static_cast<double>(std::clamp<std::int64_t>(now - earned_at_, 0, kSavedWork));
  earned_at_ = now;
  const double rate = work_per_tick_ / static_cast<double>(kTick);
  work_budget_ = std::clamp(work_budget_ + rate * elapsed, pipeline_.work(), pipeline_.work() + rate * kSavedWork);
}

/// Tiles with points of their own that are new, as far as the budget goes: those first that are new to a good part, and
/// of those the nearest; then those that have waited for long.
void UpdateSchedule::update_news(const Eigen::Vector2d& vehicle, std::int64_t now) {
  std::vector<std::tuple<bool, double, TileKey>> due;
  for (const auto& [key, news] : news_) {
    const auto before = static_cast<double>(news.num_points);
    const bool is_large = static_cast<double>(pipeline_.voted(key)->points.size()) * (1 - kLargeShare) >= before;
    if (is_large) {
      due.emplace_back(false, squared_distance(key, vehicle.x(), vehicle.y()), key);
    } else if (std::abs(now - news.since) >= kNewsPatience) {
      due.emplace_back(true, static_cast<double>(news.since), key);
    }
  }
  std::sort(due.begin(), due.end());
  for (const auto& [later, order, key] : due) {
    if (pipeline_.work() >= work_budget_) break;
    pipeline_.update(key);
    news_.erase(key);
  }
}

void UpdateSchedule::show() {
  for (auto& [key, news] : news_) {
    if (!std::exchange(news.is_shown, true)) pipeline_.update_columns(key);
  }
}

void UpdateSchedule::settle_stale(std::int64_t now) {
  if (!turns_.empty() && now < turns_.back().first) turns_.clear();  // a clock that jumps
  turns_.emplace_back(now, pipeline_.turn());
  while (turns_.size() > 1 && now - turns_[1].first >= kSettlePatience) turns_.pop_front();
  const std::int64_t before = now - turns_.front().first >= kSettlePatience ? turns_.front().second + 1 : 0;
  while (pipeline_.settle_one(before) && pipeline_.work() < work_budget_) continue;  // one at least
}

}  // namespace curbstone
