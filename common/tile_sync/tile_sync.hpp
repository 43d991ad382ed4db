#pragma once

#include <cstdint>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <deque>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone {

/// @file
/// The loss-recovery protocol of versioned tiles (docs/design.md, "State, not events"). A version is a count of points
/// or a revision. It only grows within an epoch. Both classes are pure: messages in, messages out, no bus, one thread.

/// The sender's side: the versions of its tiles. Makes TILE_INDEX pages and remembers which tiles were requested.
class TileCatalog {
 public:
  TileCatalog(std::string owner, std::string channel) : owner_(std::move(owner)), channel_(std::move(channel)) {}

  /// Discards everything of the previous epoch.
  void start_epoch(std::int32_t epoch);
  void set_version(TileKey key, std::int32_t version);
  /// Announces a tile that is still to be sent, as version 0, unless it has a version. Nobody requests it.
  void promise(TileKey key);
  void remove(TileKey key);

  /// One round of the index: first the tiles changed since the last round, then those nearest to (x, y), m in map. At
  /// most `max_tiles` (the rest take turns in later rounds), in pages of at most kTilesPerPage. Returns at least one
  /// page, even if it is empty.
  [[nodiscard]] std::vector<tile_index_t> make_index(std::int64_t utime, double x, double y,
                                                     std::size_t max_tiles = 4000);

  /// Takes a request. A request for another channel or another epoch is ignored. A tile that is already waiting is not
  /// queued twice.
  void request(const tile_request_t& message);
  struct Wanted {
    TileKey key;
    std::int32_t have;  ///< version the requester has
  };
  /// Up to `max_tiles` requested tiles whose version here is newer than the requester's, oldest request first; they
  /// leave the queue.
  [[nodiscard]] std::vector<Wanted> take_requests(std::size_t max_tiles);

  /// The number of requests in the queue.
  [[nodiscard]] std::size_t num_requested() const { return waiting_.size(); }

  static constexpr std::size_t kTilesPerPage = 1500;  ///< 12 bytes each: 18 kB
  static constexpr std::size_t kMaxWaiting = 10000;   ///< requests kept; further ones are dropped and asked again

 private:
  std::string owner_;
  std::string channel_;
  std::int32_t epoch_ = 0;
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> versions_;
  std::unordered_set<TileKey, TileKeyHash> changed_;
  std::deque<TileKey> waiting_;
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> waiting_have_;
  TileKey turn_;  ///< the last tile that was announced in turn
};

/// The listener's side: compares its own versions with the announced ones. Makes TILE_REQUESTs for the missing tiles.
class TileFollower {
 public:
  TileFollower(std::string requester, std::string channel)
      : requester_(std::move(requester)), channel_(std::move(channel)) {}

  void start_epoch(std::int32_t epoch);
  void set_have(TileKey key, std::int32_t version);
  void forget(TileKey key);
  /// Takes an index page. Returns false for another channel or an older epoch. Before passing a page of a newer epoch,
  /// the caller must call start_epoch().
  bool announced(const tile_index_t& message);
  /// A message of the tile announced `version`, but could not be applied because an earlier message is missing. The
  /// next request includes the tile without waiting for `patience`.
  void lacks(TileKey key, std::int32_t version);

  /// A request for at most `max_tiles` tiles whose announced version has been above the listener's for `patience` us;
  /// the message of a tile that was just announced is probably on its way. A tile of which all is still to come is not
  /// requested. The nearest to (x, y), m in map, come first.
  /// num_tiles is 0 if nothing is to be asked. Each tile is requested at most once a second. `now`: message time, us.
  [[nodiscard]] tile_request_t make_request(std::int64_t now, std::size_t max_tiles = 200,
                                            std::int64_t patience = 300'000, double x = 0, double y = 0);

  /// Whether a version of the tile is announced that the listener does not have.
  [[nodiscard]] bool is_behind(TileKey key) const { return behind_.contains(key); }
  /// The number of such tiles.
  [[nodiscard]] std::size_t behind() const { return behind_.size(); }
  /// Whether such a tile, announced no later than `until` (message time, us) and still missing, is nearer than `radius`
  /// to (x, y), m in map.
  [[nodiscard]] bool is_behind_near(double x, double y, double radius, std::int64_t until) const;

 private:
  struct Behind {
    std::int32_t announced = 0;
    std::int64_t since = 0;       // us; message time of the index
    std::int64_t last_asked = 0;  // us
  };
  std::string requester_;
  std::string channel_;
  std::int32_t epoch_ = 0;
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> have_;
  std::unordered_map<TileKey, Behind, TileKeyHash> behind_;
};

}  // namespace curbstone
