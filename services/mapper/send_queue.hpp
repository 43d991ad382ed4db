#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <unordered_map>

#include "common/tiles/tile.hpp"

namespace curbstone::mapper {

/// Queue of tiles to send: by rings around the vehicle, the nearest first; in a ring first in, first out. After a loop
/// closure the whole map is queued, for a minute or more: what lies beneath the vehicle goes first, and what it sees
/// for the first time does not wait behind what is far. Each tile is queued once.
class SendQueue {
 public:
  static constexpr double kRing = 5;        ///< m, width of a ring
  static constexpr std::size_t kRings = 9;  ///< the last one is all beyond 40 m: twice dense.max_range's default

  /// Sets the vehicle's position, m in map. Queued tiles that are nearer to it now move to a nearer ring.
  void set_position(double x, double y) {
    x_ = x;
    y_ = y;
    for (std::size_t ring = 1; ring < kRings; ++ring) {
      for (const TileKey& key : rings_[ring]) {
        const auto waits = ring_of_.find(key);
        if (waits != ring_of_.end() && waits->second == ring) approach(key, waits->second);
      }
    }
  }
  /// m from the vehicle to the tile's middle.
  [[nodiscard]] double distance(TileKey key) const { return std::sqrt(squared_distance(key, x_, y_)); }
  void push(TileKey key) { approach(key, ring_of_.try_emplace(key, kRings).first->second); }
  /// Whether a tile lies in the last ring.
  [[nodiscard]] bool is_far(TileKey key) const { return distance(key) >= kRing * (kRings - 1); }
  /// Puts back a far tile that pop() returned, before all others: listeners keep a far tile only until it is complete.
  void put_back(TileKey key) {
    rings_[kRings - 1].push_front(key);
    ring_of_[key] = kRings - 1;
  }
  /// Removes and returns the next tile; nothing if the queue is empty.
  [[nodiscard]] std::optional<TileKey> pop() {
    for (std::size_t ring = 0; ring < kRings; ++ring) {
      while (!rings_[ring].empty()) {
        const TileKey key = rings_[ring].front();
        rings_[ring].pop_front();
        const auto waits = ring_of_.find(key);
        if (waits == ring_of_.end() || waits->second != ring) continue;  // has moved to a nearer ring
        ring_of_.erase(waits);
        return key;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t size() const { return ring_of_.size(); }
  void clear() {
    for (std::deque<TileKey>& ring : rings_) ring.clear();
    ring_of_.clear();
  }

 private:
  /// Moves the tile to the ring that it lies in, if that is nearer than its present one.
  void approach(TileKey key, std::size_t& present) {
    const double rings = distance(key) / kRing;
    const std::size_t ring = rings < kRings - 1 ? static_cast<std::size_t>(rings) : kRings - 1;
    if (ring >= present) return;
    present = ring;
    rings_[ring].push_back(key);
  }

  double x_ = 0;
  double y_ = 0;
  std::array<std::deque<TileKey>, kRings> rings_;                  // may list tiles that have moved to a nearer one
  std::unordered_map<TileKey, std::size_t, TileKeyHash> ring_of_;  // of each queued tile
};

}  // namespace curbstone::mapper
