#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/export/curb_export.hpp"
#include "tools/export/geo/geo_datum.hpp"

namespace curbstone::map_export {

/// Lanelet2's OSM XML: each curb is a way with type=curbstone, subtype=high or low (tagging specification of Lanelet2,
/// "LinestringTagging"), and height, high_side (left or right along the way), dropped, confidence, and rise (up or
/// down, seen from the driven path).
///
/// Each node has local_x, local_y (m in map; Autoware's local projector reads these) and ele: m in map or, with a
/// datum, above the ellipsoid. lat and lon are present only with a datum, to 1e-10 deg; many readers (GDAL's too) keep
/// 1e-7 deg of them, a centimetre. Ids count from 1, nodes after ways.
[[nodiscard]] std::string lanelet2_osm(const std::vector<semantic_map::tile::CurbLine>& curbs, const CurbView& view,
                                       const std::optional<geo::TangentPlane>& plane);

}  // namespace curbstone::map_export
