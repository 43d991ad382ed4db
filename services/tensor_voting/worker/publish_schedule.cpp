#include "services/tensor_voting/worker/publish_schedule.hpp"

#include <algorithm>

#include "common/time/has_passed.hpp"

namespace curbstone::tensor_voting::worker {

void PublishSchedule::changed(TileKey key, std::int32_t revision, std::int64_t utime, std::int64_t now) {
  const auto out = published_.find(key);
  if (out != published_.end() && out->second.revision >= revision) return;
  Pending& tile = pending_.try_emplace(key, Pending{revision, utime, now, false}).first->second;
  tile.revision = revision;
  tile.utime = utime;
}

void PublishSchedule::wanted(TileKey key, std::int64_t now) {
  const auto out = published_.find(key);
  const std::int32_t revision = out == published_.end() ? 0 : out->second.revision;
  pending_.try_emplace(key, Pending{revision, now, now, true}).first->second.wanted = true;
}

void PublishSchedule::published(TileKey key, std::int32_t revision, std::int64_t now) {
  Published& out = published_[key];
  out.revision = std::max(out.revision, revision);
  if (now != 0) out.at = now;
  const auto it = pending_.find(key);
  if (it != pending_.end() && it->second.revision <= revision) pending_.erase(it);
}

void PublishSchedule::forget_far(double x, double y, double radius) {
  if (published_.size() <= kMaxRemembered) return;
  has_forgotten_ = true;
  std::erase_if(published_, [&](const auto& tile) { return squared_distance(tile.first, x, y) > radius * radius; });
}

void PublishSchedule::clear() {
  pending_.clear();
  published_.clear();
  has_forgotten_ = false;
}

double PublishSchedule::freshness(const Pending& tile, std::int64_t now) const {
  const auto age = static_cast<double>(std::max<std::int64_t>(0, now - tile.utime));
  return 1 / (1 + age / static_cast<double>(config_.fresh));
}

std::optional<TileKey> PublishSchedule::next(std::int64_t now, double x, double y) const {
  std::optional<TileKey> best;
  double best_score = -1;
  for (const auto& [key, tile] : pending_) {
    const auto it = published_.find(key);
    const Published out = it == published_.end() ? Published{0, 0} : it->second;
    if (it != published_.end() && !has_passed(config_.min_interval, out.at, now)) continue;
    const double changed = tile.wanted ? 1.0 : 1.0 - static_cast<double>(out.revision) / tile.revision;
    const std::int64_t since = std::min(tile.since, now);  // later: the clock was set back meanwhile
    const double waited = static_cast<double>(now - since) / static_cast<double>(config_.patience);
    const double nearness = 1 / (1 + squared_distance(key, x, y) / (config_.near * config_.near));
    const double score = (freshness(tile, now) * changed + waited) * nearness;
    if (score > best_score) {
      best_score = score;
      best = key;
    }
  }
  return best;
}

std::optional<TileKey> PublishSchedule::any() const {
  if (pending_.empty()) return std::nullopt;
  return pending_.begin()->first;
}

std::int32_t PublishSchedule::published_revision(TileKey key) const {
  const auto it = published_.find(key);
  return it == published_.end() ? 0 : it->second.revision;
}

bool PublishSchedule::is_wanted(TileKey key) const {
  const auto it = pending_.find(key);
  return it != pending_.end() && it->second.wanted;
}

std::optional<std::int64_t> PublishSchedule::waiting_since(TileKey key) const {
  const auto it = pending_.find(key);
  if (it == pending_.end()) return std::nullopt;
  return it->second.since;
}

}  // namespace curbstone::tensor_voting::worker
