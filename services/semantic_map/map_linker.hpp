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

/// Has the lines of the whole map linked in another thread, from what the map is at one time. That thread keeps what it
/// linked from, and is given only what has changed since: that takes as long as much has changed, however large the map
/// has grown.
class MapLinker {
 public:
  explicit MapLinker(const markings::MarkingParameters& parameters) : parameters_(parameters) { clear(); }

  /// The vehicle was there: DrivenPath::add().
  void drove(std::int64_t utime, const Eigen::Vector2d& place) { driven_.emplace_back(utime, place); }
  /// Another epoch begins: nothing is known any more.
  void clear();
  /// What links the lines as they are now; the same as link(line_sources()). To be called once, in any thread, and to
  /// have returned before this is asked for again.
  [[nodiscard]] store::MapKeeper::LinkLines link_as_is(pipeline::TilePipeline& pipeline,
                                                       std::shared_ptr<const store::StoredLines> before);

 private:
  markings::MarkingParameters parameters_;
  std::vector<std::pair<std::int64_t, Eigen::Vector2d>> driven_;  ///< since it was asked last
  std::shared_ptr<MapLineSources> sources_;                       ///< whose links it gives out: theirs
};

}  // namespace curbstone::semantic_map
