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
/// long. Its inputs are the tiles that were voted and what the work cost; the work itself is done elsewhere. The final
/// map does not depend on it: TilePipeline::settle(). `now`: us, message time or a clock; it may jump.
class UpdateSchedule {
 public:
  /// `work_per_tick`: WorkResult::cost of next_work(), each 20 ms.
  explicit UpdateSchedule(double work_per_tick) : work_per_tick_(work_per_tick) {}

  /// A tile has new points or tensors.
  void voted(const VotedChange& change, std::int64_t now);
  /// Columns and classes of the tile that has waited longest for them: cheap, and what a vehicle must know first.
  /// Ground and curbs are left to next_work(). Nothing if no tile waits.
  std::optional<TileWork> next_to_show();
  /// Ground and curbs of one tile with new points: the one of which most points have waited longest for what it costs,
  /// near the vehicle (m in map) rather than far from it, and none for much more than a second; or one step that has
  /// long been stale (most steps do not become so: their tile gets points of its own before). Stale steps get a tenth
  /// of the work however many tiles have new points. Nothing if nothing is due, or the budget is spent.
  std::optional<TileWork> next_work(const Eigen::Vector2d& vehicle, const Backlog& backlog, std::int64_t now);
  /// The work of next_work() is done, and cost so much.
  void spent(double cost);
  void clear() { pending_.clear(), unshown_.clear(); }
  /// Tiles whose curbs wait for next_work().
  [[nodiscard]] std::size_t num_waiting() const { return pending_.size(); }

 private:
  /// A tile that was voted since its ground and curbs were computed last.
  struct Pending {
    std::int64_t since = 0;         // us
    std::size_t points_before = 0;  // that it had then
    std::size_t points = 0;
    double num_steps = 0;     // with new points, since then
    double mean_step_at = 0;  // us after `since`: when they came, on average
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
  double budget_ = 0;         // of WorkResult::cost
  double settling_owed_ = 0;  // likewise: the stale steps' share of the work done so far, not yet given
  bool settles_ = false;      // whether the last work was a stale step, and not a tile's update
  std::int64_t earned_at_ = 0;
  std::deque<std::pair<std::int64_t, std::int64_t>> turns_;  // when it was whose turn, of the last second
};

}  // namespace curbstone::semantic_map::pipeline
