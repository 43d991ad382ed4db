#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/tiles/tile.hpp"

namespace curbstone::tensor_voting::worker {

/// Chooses the changed tile to publish next; each tile is published at most once every `min_interval`. If the bandwidth
/// suffices, all tiles are published. Otherwise the tile with the highest score goes first. The score is the tile's
/// share of changes, discounted by the age of its newest points, plus its waiting time, so that every tile gets its
/// turn; the sum is discounted by distance.
class PublishSchedule {
 public:
  struct Config {
    std::int64_t min_interval = 30'000;  ///< us
    std::int64_t patience = 1'000'000;   ///< us: this wait counts as much as a tile that is entirely new
    double near = 10;                    ///< m: at this distance a tile counts half
    std::int64_t fresh = 30'000;         ///< us: at this age of the newest points changes count half
  };
  explicit PublishSchedule(Config config) : config_(config) {}

  /// The tile has reached `revision`; its newest points were measured at `utime`. Ignored if that revision is already
  /// published.
  void changed(TileKey key, std::int32_t revision, std::int64_t utime, std::int64_t now);
  /// A subscriber lacks the tile: it is due at once, changed or not.
  void wanted(TileKey key, std::int64_t now);
  /// `revision` was published, by this worker or another one; `now` is 0 where it is not known when.
  void published(TileKey key, std::int32_t revision, std::int64_t now);
  /// This worker no longer owns the tile. Its published revision is kept.
  void drop(TileKey key) { pending_.erase(key); }
  /// Evicts the published revisions of tiles farther than `radius` from (x, y), m in map, if there are more than
  /// kMaxRemembered. If such a tile is reported again, it is published again, changed or not.
  void forget_far(double x, double y, double radius);
  static constexpr std::size_t kMaxRemembered = 200'000;  ///< as many tiles as semantic_map takes
  /// Whether any revision was evicted: a tile without a known revision may then have been published.
  [[nodiscard]] bool has_forgotten() const { return has_forgotten_; }
  void clear();

  /// The tile to publish now, seen from (x, y), m in map.
  [[nodiscard]] std::optional<TileKey> next(std::int64_t now, double x, double y) const;
  /// Any waiting tile, in order of keys.
  [[nodiscard]] std::optional<TileKey> any() const;

  /// The published revision of a tile; 0 if there is none.
  [[nodiscard]] std::int32_t published_revision(TileKey key) const;
  [[nodiscard]] bool is_pending(TileKey key) const { return pending_.contains(key); }
  [[nodiscard]] std::size_t num_pending() const { return pending_.size(); }
  /// Whether a subscriber lacks the tile.
  [[nodiscard]] bool is_wanted(TileKey key) const;
  /// When a waiting tile was first changed or requested since its last publication, us; nothing if it does not wait.
  [[nodiscard]] std::optional<std::int64_t> waiting_since(TileKey key) const;

 private:
  struct Pending {
    std::int32_t revision;
    std::int64_t utime;
    std::int64_t since;
    bool wanted;
  };
  struct Published {
    std::int32_t revision;
    std::int64_t at;
  };
  [[nodiscard]] double freshness(const Pending& tile, std::int64_t now) const;

  Config config_;
  std::map<TileKey, Pending> pending_;
  std::map<TileKey, Published> published_;
  bool has_forgotten_ = false;
};

}  // namespace curbstone::tensor_voting::worker
