#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "tools/export/geo/geo_datum.hpp"

namespace curbstone::map_export {

/// "solid", "dashed", "stop_line", "crossing", "other", "unknown".
[[nodiscard]] std::string marking_name(semantic_map::tile::MarkingType type);

/// The lines with two or more points, all of them within kMaxCoordinate.
[[nodiscard]] std::vector<semantic_map::tile::MarkingLine> usable_markings(
    std::vector<semantic_map::tile::MarkingLine> lines);

/// Lanelet2's OSM XML (tagging specification, "LinestringTagging"): one way per line with type=line_thin (line_thick
/// from 0.2 m) and subtype=solid or dashed; type=stop_line; type=pedestrian_marking for each edge of a crossing, across
/// its bars; type=line_thin without a subtype if the type is uncertain. Width, and dash and gap (m) of interrupted
/// lines, are tags too. Nodes as in lanelet2_osm().
[[nodiscard]] std::string markings_osm(const std::vector<semantic_map::tile::MarkingLine>& lines,
                                       const std::optional<geo::TangentPlane>& plane);

/// GeoJSON (RFC 7946): one line (geo::geojson_line) per marking, along its centre, with id, type, width, dash, gap and
/// confidence. For a dashed one, `dashes` has both ends of each painted piece in m along the line.
[[nodiscard]] std::string markings_geojson(const std::vector<semantic_map::tile::MarkingLine>& lines,
                                           const geo::TangentPlane& plane);

}  // namespace curbstone::map_export
