#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/tile.hpp"

namespace curbstone {

/// Which changed tile to publish next. Each at most every `min_interval`; a tile with little news waits until it has
/// been changed for `patience`, so that a tile is not sent again for every point that comes to it, and then for points
/// that have just been measured, but not for longer than `long_patience`. Among those that are
/// due, the one with the largest share of news goes first, discounted by its distance and by the age of its newest
/// points: when not all can go, those go whose news is still fresh, and the others when fresh news comes to them, or
/// when they have waited for long.
class PublishSchedule {
 public:
  struct Config {
    std::int64_t min_interval = 200'000;   ///< us
    std::int64_t patience = 200'000;       ///< us
    std::int64_t long_patience = 600'000;  ///< us
    std::int64_t just_now = 75'000;        ///< us: points that are no older have just been measured
    double prompt_share = 0.1;             ///< news of this share of the tile need not wait for `patience`
    double near = 10;                      ///< m: at this distance news counts half
    std::int64_t fresh = 30'000;           ///< us: at this age news counts half
    double stale = 0.03;                   ///< what the oldest news counts
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
  static constexpr std::size_t kMaxRemembered = 100'000;
  void clear();

  /// The tile to publish now, seen from (x, y), m in map.
  [[nodiscard]] std::optional<TileKey> next(std::int64_t now, double x, double y) const;
  /// Any tile that waits, in order of keys.
  [[nodiscard]] std::optional<TileKey> any() const;

  /// 0 if none was.
  [[nodiscard]] std::int32_t published_revision(TileKey key) const;
  [[nodiscard]] bool is_pending(TileKey key) const { return pending_.contains(key); }
  /// Somebody lacks it.
  [[nodiscard]] bool is_wanted(TileKey key) const;
  [[nodiscard]] std::size_t num_pending() const { return pending_.size(); }
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
};

}  // namespace curbstone
