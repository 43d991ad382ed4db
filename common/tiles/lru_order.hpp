#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>

#include "common/tiles/tile.hpp"

namespace curbstone {

/// Tiles in the order of their last use. Times in us, of a clock that somebody may set; of several uses at the same
/// time only the first counts.
class LruOrder {
 public:
  void used(TileKey key, std::int64_t now) {
    Turn& turn = turns_[key];
    if (turn.number > 0 && turn.at == now) return;
    uses_.erase(turn.number);
    turn = {++turn_, now};
    uses_.emplace_hint(uses_.end(), turn.number, key);
  }
  /// Takes the least recently used tile out of the order, if it has not been used for `period`, or since the clock was
  /// set back.
  std::optional<TileKey> take_unused(std::int64_t period, std::int64_t now) {
    if (uses_.empty()) return std::nullopt;
    const TileKey key = uses_.begin()->second;
    const std::int64_t at = turns_.at(key).at;
    if (now >= at && now - at < period) return std::nullopt;
    erase(key);
    return key;
  }
  void erase(TileKey key) {
    const auto it = turns_.find(key);
    if (it == turns_.end()) return;
    uses_.erase(it->second.number);
    turns_.erase(it);
  }
  void clear() { uses_.clear(), turns_.clear(); }
  [[nodiscard]] bool contains(TileKey key) const { return turns_.contains(key); }
  [[nodiscard]] std::size_t size() const { return turns_.size(); }

 private:
  struct Turn {
    std::int64_t number = 0;
    std::int64_t at = 0;
  };
  std::map<std::int64_t, TileKey> uses_;  // by time of use: the oldest first
  std::unordered_map<TileKey, Turn, TileKeyHash> turns_;
  std::int64_t turn_ = 0;
};

}  // namespace curbstone
