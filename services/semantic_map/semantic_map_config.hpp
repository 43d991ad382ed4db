#pragma once

#include <string>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"

namespace curbstone::semantic_map {

/// Configuration of the semantic map: section "semantic_map" of the vehicle's file.
struct SemanticMapConfig {
  std::string map = "map.db";       ///< file; empty: the map lives in memory only
  bool keep_earlier_drives = true;  ///< in files beside the map
  std::string picture;              ///< PNG of the map, written at the end; empty: none
  int work_per_tick = 11;           ///< on ground and curbs per 20 ms; the search of an average tile counts 1
  double curb_range = 20.0;         ///< m around the vehicle that CURBS and MARKINGS cover
  int max_pending_tiles = 20'000;   ///< kept in memory while the disk is full
  double keep_free = 1;             ///< GB of the disk that spilled tiles leave free
  tile::CurbParameters curb;
  cells::ClassParameters classes;
  markings::MarkingParameters markings;
  VehicleConfig vehicle;

  void visit(ConfigVisitor& v) {
    v.field("map", map, "file to keep the map in; empty: in memory only");
    v.field("keep_earlier_drives", keep_earlier_drives,
            "keep the map of an earlier drive beside the new one, as map-<its start>.db");
    v.field("picture", picture, "PNG of the map, written at the end; empty: none");
    v.field("work_per_tick", work_per_tick, {1, 1000},
            "work on ground and curbs each 20 ms; the search of an average tile is 1");
    v.field("curb_range", curb_range, {3, 100}, "m around the vehicle that CURBS and MARKINGS cover");
    v.field("max_pending_tiles", max_pending_tiles, {100, 1e6}, "tiles kept in memory while the disk is full");
    v.field("keep_free", keep_free, {0, 1e6},
            "GB of the map's disk that layers of far tiles leave free; then they stay in memory");
    v.section("curb", curb, "how curbs are found");
    v.section("classes", classes, "classes and costs of cells");
    v.section("markings", markings, "how the paint on the road is found");
    v.section("vehicle", vehicle, "shared: the vehicle");
  }
};

}  // namespace curbstone::semantic_map
