#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "services/semantic_map/curb_lines/curb_linker.hpp"
#include "services/semantic_map/kerbstones.hpp"
#include "services/semantic_map/marking_lines/marking_field.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/store/map_keeper.hpp"
#include "services/semantic_map/tile/driven_path.hpp"

/// @file
/// Links lines from the points and cells of many tiles: those around the vehicle for publication, those of the whole
/// map for its file.

namespace curbstone::semantic_map {

using MapBox = Eigen::AlignedBox2d;  ///< m in map

/// The curb points in a box.
[[nodiscard]] std::vector<curb_lines::MapCurbPoint> curb_points_in(const MapBox& box,
                                                                   const pipeline::TilePipeline& pipeline);
/// The cells of paint in a box, including those on kerbstones.
[[nodiscard]] std::vector<marking_lines::MapMarkingCell> marking_cells_in(const MapBox& box,
                                                                          const pipeline::TilePipeline& pipeline);

/// Returns a tile by its key; nullptr if there is none.
using TileLookup = std::function<std::shared_ptr<const tile::MapTile>(TileKey key)>;
/// Links curbs and adds bridges over ground that the tiles show (curb_lines::add_bridges()).
[[nodiscard]] std::vector<tile::CurbLine> link_and_bridge_curbs(const std::vector<curb_lines::MapCurbPoint>& points,
                                                                const TileLookup& tiles);
/// Links the road markings, from the cells that are not on kerbstones (marking_lines::link_marking_cells()). Lines
/// beyond a raised kerb, seen from the path, are left out: yards and lawns have bright strips, too. Beyond a lowered or
/// flush kerb, only long lines and crossings are kept. `tiles` say where ground was seen.
[[nodiscard]] std::vector<tile::MarkingLine> link_road_markings(std::vector<marking_lines::MapMarkingCell> cells,
                                                                const Kerbstones& kerbs, const tile::DrivenPath& path,
                                                                const markings::MarkingParameters& parameters,
                                                                const TileLookup& tiles);

/// The curb lines of the whole map.
[[nodiscard]] std::vector<tile::CurbLine> all_curbs(const pipeline::TilePipeline& pipeline);
/// The markings of the whole map. `curbs`: its curb lines. `path`: as driven.
[[nodiscard]] std::vector<tile::MarkingLine> all_markings(const pipeline::TilePipeline& pipeline,
                                                          const std::vector<tile::CurbLine>& curbs,
                                                          const tile::DrivenPath& path,
                                                          const markings::MarkingParameters& parameters);

/// The inputs of line linking for one tile, a snapshot. It is shared with the pipeline, and immutable.
struct LineTile {
  std::shared_ptr<const std::vector<curbs::CurbPoint>> curbs;
  std::shared_ptr<const std::vector<markings::MarkingCell>> markings;
  std::shared_ptr<const tile::MapTile> classes;  ///< nullptr: not known yet
};
/// Snapshot of a tile of the pipeline.
[[nodiscard]] LineTile line_tile(TileKey key, const pipeline::TilePipeline& pipeline);

/// The inputs of line linking for the whole map, a snapshot. Linking takes longer the larger the map is; with a
/// snapshot it can run in another thread.
struct MapLineSources {
  std::unordered_map<TileKey, LineTile, TileKeyHash> tiles;
  tile::DrivenPath path;
  markings::MarkingParameters markings;
  std::shared_ptr<const store::StoredLines>
      before;  ///< lines of a predecessor, some of whose tiles may not be known yet
};
[[nodiscard]] MapLineSources line_sources(const pipeline::TilePipeline& pipeline, const tile::DrivenPath& path,
                                          const markings::MarkingParameters& parameters);
/// Links the snapshot: the same lines as all_curbs() and all_markings() gave then, and those parts of `before` that lie
/// in tiles that only the predecessor had.
[[nodiscard]] tile::MapLines link(const MapLineSources& sources);

}  // namespace curbstone::semantic_map
