#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::tensor_voting::worker {

/// Assigns each tile to a worker by rendezvous hashing: every worker ranks all live workers for a tile by a hash of
/// both, and the highest one owns the tile. This needs no negotiation. When a worker joins or leaves, only its own
/// tiles move.
///
/// Tiles are assigned in blocks of 4 x 4, so that most of a worker's tiles have no neighbour that another worker owns.
class RendezvousOwners {
 public:
  /// `timeout`, us: a worker that was not heard for so long has left.
  RendezvousOwners(std::string self, std::int64_t timeout);

  /// A heartbeat of worker `name` at `now`. Own heartbeats are ignored. Owners do not change before update().
  void on_heartbeat(const std::string& name, std::int64_t now);
  /// Adds new workers and drops those that have left. Returns true if owners have changed.
  bool update(std::int64_t now);
  [[nodiscard]] bool owns(TileKey key) const;
  [[nodiscard]] std::size_t count() const { return others_.size() + 1; }

  static constexpr int kTilesPerBlock = 4;
  static constexpr std::size_t kMaxWorkers = 64;  ///< further workers are ignored

 private:
  std::string self_;
  std::int64_t timeout_;
  std::map<std::string, std::int64_t> last_heard_;
  std::vector<std::string> others_;  // the workers that share the tiles with this one, as of the last update()
};

}  // namespace curbstone::tensor_voting::worker
