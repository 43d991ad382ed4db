#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::tensor_voting::worker {

/// Who votes for which tile. Rendezvous hashing: every worker ranks all live workers for a tile by a hash of both, the
/// highest one owns it. No worker needs to ask another; when one comes or goes, only its own tiles move.
///
/// Tiles go in blocks of 4 x 4, so that most of a worker's tiles have no neighbour of another worker's.
class RendezvousOwners {
 public:
  /// `timeout`, us: who has not been heard for so long is gone.
  RendezvousOwners(std::string self, std::int64_t timeout);

  /// A sign of life at `now`. One's own does not count: one is alive anyway. It changes no owner before update().
  void heard(const std::string& name, std::int64_t now);
  /// Takes in who has come and drops who is gone. True when owners have changed with it.
  bool update(std::int64_t now);
  [[nodiscard]] bool owns(TileKey key) const;
  [[nodiscard]] std::size_t count() const { return others_.size() + 1; }

  static constexpr int kTilesPerBlock = 4;
  static constexpr std::size_t kMaxWorkers = 64;  ///< more are not listened to

 private:
  std::string self_;
  std::int64_t timeout_;
  std::map<std::string, std::int64_t> last_heard_;
  std::vector<std::string> others_;  // who shares the tiles with us, as of the last update()
};

}  // namespace curbstone::tensor_voting::worker
