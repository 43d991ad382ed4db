#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::mapper::dense_map {

/// Tiles that someone must read and that the file of far tiles could not return: they are tried again after 1 s, 2 s, 4
/// s, and so on, at last each minute. Pure; one thread.
class UnreadableTiles {
 public:
  /// A tile could not be read. `now`: us.
  void add(TileKey key, std::int64_t now) { tiles_.try_emplace(key, Wait{now, kMinWait}); }
  /// The tile was read, or is not needed any more.
  void remove(TileKey key) {
    if (!tiles_.empty()) tiles_.erase(key);
  }
  void clear() { tiles_.clear(); }
  [[nodiscard]] std::size_t size() const { return tiles_.size(); }

  /// The tiles to be tried now, in order. They stay listed until remove(). `now`: us; if the clock was set back, all.
  [[nodiscard]] std::vector<TileKey> take_due(std::int64_t now) {
    std::vector<TileKey> due;
    for (auto& [key, wait] : tiles_) {
      if (now >= wait.since && now - wait.since < wait.length) continue;
      wait = {now, std::min(2 * wait.length, kMaxWait)};
      due.push_back(key);
    }
    std::sort(due.begin(), due.end());
    return due;
  }

 private:
  static constexpr std::int64_t kMinWait = 1'000'000;   // us
  static constexpr std::int64_t kMaxWait = 60'000'000;  // us
  struct Wait {
    std::int64_t since;   // us
    std::int64_t length;  // us
  };
  std::unordered_map<TileKey, Wait, TileKeyHash> tiles_;
};

}  // namespace curbstone::mapper::dense_map
