#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "services/semantic_map/map_lines.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/store/map_keeper.hpp"

namespace curbstone::semantic_map {

/// Links the lines of the whole map in another thread, from snapshots. That thread keeps its inputs and receives only
/// what has changed since: the cost depends on the amount of change, not on the size of the map.
class MapLinker {
 public:
  explicit MapLinker(const markings::MarkingParameters& parameters) : parameters_(parameters) { clear(); }

  /// Adds a place of the vehicle: DrivenPath::add().
  void add_place(std::int64_t utime, const Eigen::Vector2d& place) { driven_.emplace_back(utime, place); }
  /// Discards everything: another epoch begins.
  void clear();
  /// Returns a function that links the lines as they are now, with the same result as link(line_sources()). It is to be
  /// called once, in any thread, and must have returned before link_snapshot() is called again.
  [[nodiscard]] store::MapKeeper::LinkLines link_snapshot(pipeline::TilePipeline& pipeline,
                                                          std::shared_ptr<const store::StoredLines> before);

 private:
  markings::MarkingParameters parameters_;
  std::vector<std::pair<std::int64_t, Eigen::Vector2d>> driven_;  ///< since the last link_snapshot()
  std::shared_ptr<MapLineSources> sources_;                       ///< owned by the function handed out, while it runs
};

}  // namespace curbstone::semantic_map
