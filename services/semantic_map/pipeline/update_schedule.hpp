#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/pipeline/tile_work.hpp"

namespace curbstone::semantic_map::pipeline {

/// Says what of the map is computed when, so that what was just seen is shown at once and a core is never busy for
/// long. It is told what was voted and what the work cost, and does nothing itself. What the map finally is does not
/// depend on it: TilePipeline::settle(). Message time or a clock, `now`, us; it may jump.
class UpdateSchedule {
 public:
  /// `work_per_tick`: WorkResult::cost of next_work(), each 20 ms.
  explicit UpdateSchedule(double work_per_tick) : work_per_tick_(work_per_tick) {}

  /// A tile is voted anew.
  void voted(const VotedChange& change, std::int64_t now);
  /// The work that shows what stands where in the tile that changed first of those that do not show it yet: cheap, and
  /// what a vehicle must know first. Where ground and curbs are is left to next_work(). Nothing if all show it.
  std::optional<TileWork> next_to_show();
  /// The work that looks for ground and curbs in one tile where that is due, the nearest to the vehicle (m in map)
  /// first, or that brings up to date what has long been stale: most of it was before, with points of its own. The
  /// latter gets a tenth of the work however much news there is. Nothing if nothing is due, or the budget is spent.
  std::optional<TileWork> next_work(const Eigen::Vector2d& vehicle, const Backlog& backlog, std::int64_t now);
  /// The work of next_work() is done, and cost so much.
  void spent(double cost);
  void clear() { news_.clear(), unshown_.clear(); }
  /// Tiles whose curbs wait for next_work().
  [[nodiscard]] std::size_t num_waiting() const { return news_.size(); }

 private:
  /// Of a tile that was voted anew since it was brought up to date.
  struct News {
    std::int64_t since = 0;         // us
    std::size_t points_before = 0;  // that it had when it was brought up to date last
    std::size_t points = 0;
    bool is_shown = false;  // its columns and classes know of all points; else it is in unshown_
  };
  void earn_work(std::int64_t now);
  std::optional<TileWork> take_news(const Eigen::Vector2d& vehicle, std::int64_t now);
  bool is_settling_due(const Backlog& backlog, std::int64_t now);

  double work_per_tick_;
  std::map<TileKey, News> news_;
  std::deque<TileKey> unshown_;
  double budget_ = 0;         // of WorkResult::cost
  double settling_owed_ = 0;  // likewise: its share of the work that news took, not yet given
  bool settles_ = false;      // whether the work that was given last brings up to date what was stale
  std::int64_t earned_at_ = 0;
  std::deque<std::pair<std::int64_t, std::int64_t>> turns_;  // when it was whose turn, of the last second
};

}  // namespace curbstone::semantic_map::pipeline
