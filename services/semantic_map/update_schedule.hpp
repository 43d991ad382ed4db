#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <utility>

#include "common/tile.hpp"
#include "services/semantic_map/tile_pipeline.hpp"

namespace curbstone {

/// What of the map is computed when, so that what was just seen is shown at once and a core is never busy for long.
/// What the map finally is does not depend on it: TilePipeline::settle(). Message time or a clock, `now`, us; it may
/// jump.
class UpdateSchedule {
 public:
  /// `work_per_tick`: of TilePipeline::work(), each 20 ms, beside show_one().
  UpdateSchedule(double work_per_tick, TilePipeline& pipeline);

  /// The tile is voted anew; it had so many points before.
  void changed(TileKey key, std::size_t points_before, std::int64_t now);
  /// What stands where in the tile that changed first of those that do not show it yet: cheap, and what a vehicle must
  /// know first. Where ground and curbs are is left to work_on_one(). False if all show it.
  bool show_one();
  /// Looks for ground and curbs in one tile where that is due, the nearest to the vehicle (m in map) first, or brings
  /// up to date what has long been stale: most of it was before, with points of its own. False if nothing is due, or
  /// the budget is spent.
  bool work_on_one(const Eigen::Vector2d& vehicle, std::int64_t now);
  void clear() { news_.clear(), unshown_.clear(); }
  /// Tiles whose curbs wait for work().
  [[nodiscard]] std::size_t num_waiting() const { return news_.size(); }

 private:
  /// Of a tile that was voted anew since it was brought up to date.
  struct News {
    std::int64_t since = 0;      // us
    std::size_t num_points = 0;  // that it had when it was brought up to date last
    bool is_shown = false;       // its columns and classes know of all points; else it is in unshown_
  };
  void earn_work(std::int64_t now);
  bool update_news(const Eigen::Vector2d& vehicle, std::int64_t now);
  bool settle_stale(std::int64_t now);

  double work_per_tick_;
  TilePipeline& pipeline_;
  std::map<TileKey, News> news_;
  std::deque<TileKey> unshown_;
  double budget_ = 0;  // of pipeline_.work()
  std::int64_t earned_at_ = 0;
  std::deque<std::pair<std::int64_t, std::int64_t>> turns_;  // when it was whose turn, of the last second
};

}  // namespace curbstone
