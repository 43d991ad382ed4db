#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/tiles/tile.hpp"

namespace curbstone::tensor_voting::worker {

/// Which changed tile to publish next, each at most every `min_interval`. While all can go, all go. Otherwise the tile
/// with the highest score goes first: its share of changes, which counts less with the age of its newest points, plus
/// the time for which it has waited, so that every tile's turn comes; all of that counts less with distance.
class PublishSchedule {
 public:
  struct Config {
    std::int64_t min_interval = 30'000;  ///< us
    std::int64_t patience = 1'000'000;   ///< us: a wait that counts as much as a tile that is all new
    double near = 10;                    ///< m: at this distance a tile counts half
    std::int64_t fresh = 30'000;         ///< us: at this age of the newest points changes count half
  };
  explicit PublishSchedule(Config config) : config_(config) {}

  /// The tile has reached `revision`; its newest points were measured at `utime`. Nothing if that is published already.
  void changed(TileKey key, std::int32_t revision, std::int64_t utime, std::int64_t now);
  /// Somebody lacks the tile: it is due at once, changed or not.
  void wanted(TileKey key, std::int64_t now);
  /// `revision` is out, from us or from another worker.
  void published(TileKey key, std::int32_t revision, std::int64_t now);
  /// No longer ours to publish. What has been published remains known.
  void drop(TileKey key) { pending_.erase(key); }
  /// Forgets what has been published of tiles farther than `radius` from (x, y), m in map, if that is more than
  /// kMaxRemembered tiles: should they change again, they are published again, changed or not.
  void forget_far(double x, double y, double radius);
  static constexpr std::size_t kMaxRemembered = 200'000;  ///< as many tiles as semantic_map takes
  /// Whether that happened: what it does not know of may have been published.
  [[nodiscard]] bool has_forgotten() const { return has_forgotten_; }
  void clear();

  /// The tile to publish now, seen from (x, y), m in map.
  [[nodiscard]] std::optional<TileKey> next(std::int64_t now, double x, double y) const;
  /// Any tile that waits, in order of keys.
  [[nodiscard]] std::optional<TileKey> any() const;

  /// 0 if none was.
  [[nodiscard]] std::int32_t published_revision(TileKey key) const;
  [[nodiscard]] bool is_pending(TileKey key) const { return pending_.contains(key); }
  [[nodiscard]] std::size_t num_pending() const { return pending_.size(); }
  /// Somebody lacks it.
  [[nodiscard]] bool is_wanted(TileKey key) const;
  /// When a tile that waits was first changed, or asked for, since it was published, us; nothing if it does not wait.
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
