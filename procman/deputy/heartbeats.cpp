#include "procman/deputy/heartbeats.hpp"

#include <algorithm>

#include "common/time/microseconds.hpp"

namespace curbstone::procman::deputy {

namespace {
constexpr std::int64_t kLooks = 1'000'000;  // us between two calls that are not a pause
}

void Heartbeats::begin(const std::string& id, double seconds, std::int64_t now) {
  if (seconds <= 0) return end(id);
  lives_[id] = {.patience = microseconds(seconds), .heard = now};
}

void Heartbeats::hear(const std::string& id, bool faultless, std::int64_t now) {
  const auto it = lives_.find(id);
  if (it == lives_.end()) return;
  it->second.heard = now;
  it->second.alive = true;
  it->second.ready |= faultless;
}

std::vector<std::string> Heartbeats::take_silent(std::int64_t now) {
  const bool deaf = is_deaf(now);
  const bool paused = looked_ != 0 && now - looked_ >= kLooks;
  const std::int64_t deaf_since = was_deaf_ ? looked_ : itself_;
  const std::int64_t pause = deaf ? now - deaf_since : paused ? now - looked_ : 0;
  looked_ = now;
  was_deaf_ = deaf;
  std::vector<std::string> silent;
  for (auto& [id, life] : lives_) {
    life.heard += pause;
    const std::int64_t patience = life.alive ? life.patience : std::max(life.patience, kFirst);
    if (life.taken || now - life.heard <= patience) continue;
    life.taken = true;
    silent.push_back(id);
  }
  return silent;
}

std::vector<std::pair<std::string, double>> Heartbeats::quiet(std::int64_t now) const {
  std::vector<std::pair<std::string, double>> all;
  if (is_deaf(now)) return all;
  for (const auto& [id, life] : lives_) {
    if (life.alive && !life.taken && now - life.heard > kQuiet)
      all.emplace_back(id, static_cast<double>(now - life.heard) * 1e-6);
  }
  return all;
}

bool Heartbeats::alive(const std::string& id) const {
  const auto it = lives_.find(id);
  return it == lives_.end() || it->second.alive;
}

bool Heartbeats::ready(const std::string& id) const {
  const auto it = lives_.find(id);
  return it == lives_.end() || it->second.ready;
}

}  // namespace curbstone::procman::deputy
