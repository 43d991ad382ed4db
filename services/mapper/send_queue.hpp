#pragma once

#include <deque>
#include <optional>
#include <unordered_map>

#include "common/tiles/tile.hpp"

namespace curbstone::mapper {

/// Queue of tiles to send: tiles near the vehicle before all others, each group first in, first out. After a loop
/// closure the whole map is queued, for a minute or more; tiles that the vehicle sees for the first time do not wait
/// behind it. Each tile is queued once.
class SendQueue {
 public:
  static constexpr double kNear = 40;  ///< m from the vehicle to a tile's middle: twice dense.max_range's default

  /// Sets the vehicle's position, m in map. Queued tiles that are near it now move to the near group.
  void set_position(double x, double y) {
    x_ = x;
    y_ = y;
    for (const TileKey& key : far_) {
      const auto waits = is_near_.find(key);
      if (waits == is_near_.end() || waits->second || !is_near(key)) continue;
      waits->second = true;
      near_.push_back(key);
    }
  }
  void push(TileKey key) {
    const auto [waits, is_new] = is_near_.try_emplace(key, is_near(key));
    if (is_new) {
      (waits->second ? near_ : far_).push_back(key);
    } else if (!waits->second && is_near(key)) {
      waits->second = true;
      near_.push_back(key);
    }
  }
  /// Removes and returns the next tile; nothing if the queue is empty.
  [[nodiscard]] std::optional<TileKey> pop() {
    for (std::deque<TileKey>* queue : {&near_, &far_}) {
      while (!queue->empty()) {
        const TileKey key = queue->front();
        queue->pop_front();
        const auto waits = is_near_.find(key);
        if (waits == is_near_.end() || waits->second != (queue == &near_)) continue;  // has moved to the other group
        is_near_.erase(waits);
        return key;
      }
    }
    return std::nullopt;
  }
  void clear() {
    near_.clear();
    far_.clear();
    is_near_.clear();
  }

 private:
  [[nodiscard]] bool is_near(TileKey key) const { return squared_distance(key, x_, y_) < kNear * kNear; }

  double x_ = 0;
  double y_ = 0;
  std::deque<TileKey> near_;
  std::deque<TileKey> far_;
  std::unordered_map<TileKey, bool, TileKeyHash> is_near_;  // of each queued tile: whether it is in the near group
};

}  // namespace curbstone::mapper
