#pragma once

#include <cstdint>
#include <curbstone/curb_lines_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/tiles/tile.hpp"
#include "tools/bench/latency/timed_process.hpp"

namespace curbstone::bench::latency {

/// Median, 95th percentile and maximum, ms.
struct AgeFigures {
  std::size_t count = 0;
  double p50 = 0, p95 = 0, max = 0;
};

/// The age of measurements when they are sent: of a tile's newest points when its MAP_POINTS, VOTED_POINTS (all pages)
/// and SEMANTIC_TILE are sent. A tile that is sent again only because of its neighbours, without newer points of its
/// own, does not count, nor does what was measured before the present epoch of the map. Also the age of the points of
/// every MAP_POINTS when the first SEMANTIC_TILE of their tile includes them, when the first whose curbs include them
/// is sent, and at the CURBS that follows it, if its box covers the tile.
class TileAges {
 public:
  void on_message(const TimedMessage& message);
  /// Those of the part of the drive that follows: none yet, of the same epoch.
  [[nodiscard]] TileAges next_part() const;

  [[nodiscard]] AgeFigures age(const std::string& channel) const;
  /// Age of the points of each MAP_POINTS when their tile is sent. Points that changed nothing in the tile do not
  /// count.
  [[nodiscard]] AgeFigures news() const;
  /// The same, when the tile's curbs include them.
  [[nodiscard]] AgeFigures curb_news() const;
  /// The same, when the polylines of CURBS include them.
  [[nodiscard]] AgeFigures line_news() const;
  /// Tiles sent, including those sent because of their neighbours.
  [[nodiscard]] std::size_t sent(const std::string& channel) const;
  /// Bytes sent on a channel, all pages included.
  [[nodiscard]] double megabytes(const std::string& channel) const;

 private:
  struct Channel {
    std::map<TileKey, std::int64_t> newest;  // us, time of measurement
    std::vector<double> ages;                // ms
    std::size_t sent = 0;
    std::size_t bytes = 0;
  };
  void follow_epoch(std::int32_t epoch, std::int64_t at);
  void sent_tile(const std::string& channel, TileKey key, std::int64_t utime, std::int64_t at);
  std::map<std::string, Channel> channels_;
  struct Measured {
    TileKey key;
    std::int64_t utime = 0;  // us
  };
  /// Points that are not sent yet.
  struct News {
    std::map<TileKey, std::vector<std::int64_t>> waiting;  // us, time of measurement
    std::vector<double> ages;                              // ms
    /// Returns the points that are sent with this tile.
    std::vector<Measured> out(TileKey key, std::int64_t utime, std::int64_t at);
  };
  void say_lines(const curb_lines_t& message, std::int64_t at);
  std::optional<std::int32_t> epoch_;
  std::int64_t epoch_began_ = 0;  // us; 0: it is the first one
  News tiles_, curbs_;
  std::vector<Measured> unsaid_;   // of curbs_, sent since the last CURBS
  std::vector<double> said_ages_;  // ms
};

}  // namespace curbstone::bench::latency
