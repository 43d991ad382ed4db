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
/// Lines from the points and cells of many tiles: those about the vehicle for the bus, those of the whole map for its
/// file.

namespace curbstone::semantic_map {

using MapBox = Eigen::AlignedBox2d;  ///< m in map

/// The curb points in a box.
[[nodiscard]] std::vector<curb_lines::MapCurbPoint> curb_points_in(const MapBox& box,
                                                                   const pipeline::TilePipeline& pipeline);
/// The cells of paint in a box, those on kerbstones too.
[[nodiscard]] std::vector<marking_lines::MapMarkingCell> marking_cells_in(const MapBox& box,
                                                                          const pipeline::TilePipeline& pipeline);

/// Gives a tile by its key; nullptr for none.
using TileLookup = std::function<std::shared_ptr<const tile::MapTile>(TileKey key)>;
/// Linked, with bridges over ground that the tiles show (curb_lines::add_bridges()).
[[nodiscard]] std::vector<tile::CurbLine> link_and_bridge_curbs(const std::vector<curb_lines::MapCurbPoint>& points,
                                                                const TileLookup& tiles);
/// The markings of the road, of the cells that are not on the stones of kerbs (marking_lines::link_marking_cells()).
/// Lines beyond a raised kerb, seen from the path, are left out: yards and lawns have bright strips, too. Beyond one
/// that is lowered or lies flush only long lines and crossings are kept.
[[nodiscard]] std::vector<tile::MarkingLine> link_road_markings(std::vector<marking_lines::MapMarkingCell> cells,
                                                                const Kerbstones& kerbs, const tile::DrivenPath& path,
                                                                const markings::MarkingParameters& parameters);

/// The curb lines of the whole map.
[[nodiscard]] std::vector<tile::CurbLine> all_curbs(const pipeline::TilePipeline& pipeline);
/// The markings of the whole map. `curbs`: its curb lines. `path`: driven.
[[nodiscard]] std::vector<tile::MarkingLine> all_markings(const pipeline::TilePipeline& pipeline,
                                                          const std::vector<tile::CurbLine>& curbs,
                                                          const tile::DrivenPath& path,
                                                          const markings::MarkingParameters& parameters);

/// Of one tile, what lines are linked from, as it was at one time. It is shared with the pipeline, and never changed.
struct LineTile {
  std::shared_ptr<const std::vector<curbs::CurbPoint>> curbs;
  std::shared_ptr<const std::vector<markings::MarkingCell>> markings;
  std::shared_ptr<const tile::MapTile> classes;  ///< nullptr: not known yet
};
/// Of a tile that the pipeline has.
[[nodiscard]] LineTile line_tile(TileKey key, const pipeline::TilePipeline& pipeline);

/// What the lines of the whole map are linked from, as it was at one time. To link takes longer the larger the map is;
/// this can be done in another thread.
struct MapLineSources {
  std::unordered_map<TileKey, LineTile, TileKeyHash> tiles;
  tile::DrivenPath path;
  markings::MarkingParameters markings;
  std::shared_ptr<const store::StoredLines> before;  ///< of a predecessor, whose tiles need not all be known any more
};
[[nodiscard]] MapLineSources line_sources(const pipeline::TilePipeline& pipeline, const tile::DrivenPath& path,
                                          const markings::MarkingParameters& parameters);
/// The same as all_curbs() and all_markings() then, and those parts of the lines before that lie in tiles that only
/// the predecessor had.
[[nodiscard]] tile::MapLines link(const MapLineSources& sources);

}  // namespace curbstone::semantic_map
