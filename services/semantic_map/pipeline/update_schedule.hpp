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

/// Decides which part of the map is computed next, so that new points are shown at once and a core is never busy for
/// long. Its inputs are the tiles with new votes and the cost of the work done. The final map does not depend on it:
/// see TilePipeline::settle(). `now`: us, of message time or of a clock; it may jump.
class UpdateSchedule {
 public:
  /// `work_per_tick`: WorkResult::cost of next_work(), each 20 ms.
  explicit UpdateSchedule(double work_per_tick) : work_per_tick_(work_per_tick) {}

  /// A tile has new points or tensors.
  void voted(const VotedChange& change, std::int64_t now);
  /// Columns and classes of the tile that has waited longest for them: they are cheap, and what a vehicle must know
  /// first. Ground and curbs are left to next_work(). Nothing if no tile waits.
  std::optional<TileWork> next_to_show();
  /// Either ground and curbs of one tile with new points, or one step that has been stale for long.
  ///
  /// Of the tiles: the most urgent one (urgency()). Tiles near the vehicle (m in map) go first, and no tile waits for
  /// much more than a second. Most stale steps need no turn of their own, because their tile gets new points before.
  /// Stale steps get a tenth of the work, however many tiles have new points. Nothing if no work is due, or the budget
  /// is spent.
  std::optional<TileWork> next_work(const Eigen::Vector2d& vehicle, const Backlog& backlog, std::int64_t now);
  /// The work that next_work() returned is done, at this cost.
  void spent(double cost);
  void clear() { pending_.clear(), unshown_.clear(); }
  /// Tiles whose curbs wait for next_work().
  [[nodiscard]] std::size_t num_waiting() const { return pending_.size(); }

 private:
  /// A tile with new votes since its ground and curbs were last computed.
  struct Pending {
    std::int64_t since = 0;         // us
    std::size_t points_before = 0;  // at that time
    std::size_t points = 0;
    double num_steps = 0;     // steps of VOTED_POINTS since then
    double mean_step_at = 0;  // us after `since`: mean time of their arrival
    double cost = 0;          // of its last update; 0: there was none
    bool is_shown = false;    // its columns and classes include all points; else it is in unshown_
  };
  [[nodiscard]] static double urgency(const Pending& pending, double distance, std::int64_t now);
  void earn_work(std::int64_t now);
  std::optional<TileWork> take_pending(const Eigen::Vector2d& vehicle, std::int64_t now);
  bool is_settling_due(const Backlog& backlog, std::int64_t now);

  double work_per_tick_;
  std::map<TileKey, Pending> pending_;
  std::deque<TileKey> unshown_;
  double budget_ = 0;         // WorkResult::cost that may be spent now
  double settling_owed_ = 0;  // likewise: the share of the stale steps in the work done so far, not yet spent on them
  bool settles_ = false;      // whether the last work was a stale step, and not the update of a tile
  std::int64_t earned_at_ = 0;
  std::deque<std::pair<std::int64_t, std::int64_t>> turns_;  // time and Backlog::turn, over the last second
};

}  // namespace curbstone::semantic_map::pipeline
