#include "procman/deputy/heartbeats.hpp"

#include <algorithm>

#include "common/time/microseconds.hpp"

namespace curbstone::procman::deputy {

namespace {
constexpr std::int64_t kMaxCheckGap = 1'000'000;  // us between two calls that are not a pause
}

void Heartbeats::begin(const std::string& id, double seconds, std::int64_t now) {
  if (seconds <= 0) return end(id);
  watched_[id] = {.patience = microseconds(seconds), .heard = now};
}

void Heartbeats::on_status(const std::string& id, bool faultless, std::int64_t now) {
  const auto it = watched_.find(id);
  if (it == watched_.end()) return;
  it->second.heard = now;
  it->second.alive = true;
  it->second.ready |= faultless;
}

std::vector<std::string> Heartbeats::take_timed_out(std::int64_t now) {
  const bool bus_silent = is_bus_silent(now);
  const bool paused = checked_at_ != 0 && now - checked_at_ >= kMaxCheckGap;
  const std::int64_t bus_silent_since = was_bus_silent_ ? checked_at_ : own_status_at_;
  const std::int64_t pause = bus_silent ? now - bus_silent_since : paused ? now - checked_at_ : 0;
  checked_at_ = now;
  was_bus_silent_ = bus_silent;
  std::vector<std::string> silent;
  for (auto& [id, entry] : watched_) {
    entry.heard += pause;
    const std::int64_t patience = entry.alive ? entry.patience : std::max(entry.patience, kFirst);
    if (entry.reported || now - entry.heard <= patience) continue;
    entry.reported = true;
    silent.push_back(id);
  }
  return silent;
}

std::vector<std::pair<std::string, double>> Heartbeats::overdue(std::int64_t now) const {
  std::vector<std::pair<std::string, double>> all;
  if (is_bus_silent(now)) return all;
  for (const auto& [id, entry] : watched_) {
    if (entry.alive && !entry.reported && now - entry.heard > kOverdue)
      all.emplace_back(id, static_cast<double>(now - entry.heard) * 1e-6);
  }
  return all;
}

bool Heartbeats::alive(const std::string& id) const {
  const auto it = watched_.find(id);
  return it == watched_.end() || it->second.alive;
}

bool Heartbeats::ready(const std::string& id) const {
  const auto it = watched_.find(id);
  return it == watched_.end() || it->second.ready;
}

}  // namespace curbstone::procman::deputy
