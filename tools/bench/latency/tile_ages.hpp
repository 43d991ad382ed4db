#pragma once

#include <cstdint>
#include <curbstone/curb_lines_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "common/tiles/tile.hpp"
#include "tools/bench/latency/timed_process.hpp"

namespace curbstone::bench::latency {

/// p50, p95 and the largest of some milliseconds.
struct AgeFigures {
  std::size_t count = 0;
  double p50 = 0, p95 = 0, max = 0;
};

/// How old measurements are when they are on the bus: a tile's newest points when its MAP_POINTS, VOTED_POINTS (all
/// pages) and SEMANTIC_TILE are sent. A tile that is sent again without newer points of its own, for its neighbours'
/// sake, does not count. And from every MAP_POINTS to the first SEMANTIC_TILE of its tile that knows of them, to the
/// first whose curbs do, and to the CURBS that follows it, if that speaks of the tile.
class TileAges {
 public:
  void hear(const TimedMessage& message);

  [[nodiscard]] AgeFigures age(const std::string& channel) const;
  /// Of the points of each MAP_POINTS, when their tile is out. Those that changed nothing in it do not count.
  [[nodiscard]] AgeFigures news() const;
  /// The same, when its curbs know of them.
  [[nodiscard]] AgeFigures curb_news() const;
  /// The same, when the polylines do.
  [[nodiscard]] AgeFigures line_news() const;
  /// Tiles sent, those for their neighbours' sake too.
  [[nodiscard]] std::size_t sent(const std::string& channel) const;
  /// What was sent on a channel, all pages of it.
  [[nodiscard]] double megabytes(const std::string& channel) const;

 private:
  struct Channel {
    std::map<TileKey, std::int64_t> newest;  // us, measured
    std::vector<double> ages;                // ms
    std::size_t sent = 0;
    std::size_t bytes = 0;
  };
  void sent_tile(const std::string& channel, TileKey key, std::int64_t utime, std::int64_t at);
  std::map<std::string, Channel> channels_;
  struct Measured {
    TileKey key;
    std::int64_t utime = 0;  // us
  };
  /// Points that are not out yet.
  struct News {
    std::map<TileKey, std::vector<std::int64_t>> waiting;  // us, measured
    std::vector<double> ages;                              // ms
    /// Returns what is out now.
    std::vector<Measured> out(TileKey key, std::int64_t utime, std::int64_t at);
  };
  void say_lines(const curb_lines_t& message, std::int64_t at);
  News tiles_, curbs_;
  std::vector<Measured> unsaid_;   // of curbs_, since the last CURBS
  std::vector<double> said_ages_;  // ms
};

}  // namespace curbstone::bench::latency
