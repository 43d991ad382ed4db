#include "services/semantic_map/map_linker.hpp"

#include <utility>

namespace curbstone::semantic_map {

void MapLinker::clear() {
  driven_.clear();
  sources_ = std::make_shared<MapLineSources>();
  sources_->markings = parameters_;
}

store::MapKeeper::LinkLines MapLinker::link_snapshot(pipeline::TilePipeline& pipeline,
                                                     std::shared_ptr<const store::StoredLines> before) {
  std::vector<std::pair<TileKey, LineTile>> changed;
  for (const TileKey& key : pipeline.take_changed()) changed.emplace_back(key, line_tile(key, pipeline));
  return [sources = sources_, changed = std::move(changed), driven = std::exchange(driven_, {}),
          before = std::move(before)] {
    for (const auto& [key, tile] : changed) sources->tiles.insert_or_assign(key, tile);
    for (const auto& [utime, place] : driven) sources->path.add(utime, place);
    sources->before = before;
    return link(*sources);
  };
}

}  // namespace curbstone::semantic_map
