#pragma once

#include <string>
#include <vector>

#include "tools/export/curb_export.hpp"
#include "tools/export/geo/geo_datum.hpp"

namespace curbstone::map_export {

/// GeoJSON (RFC 7946): one line (geo::geojson_line) per curb, with id, subtype, height, high_side, dropped, confidence
/// and rise (up, down or unknown, from the driven path).
[[nodiscard]] std::string curbs_geojson(const std::vector<semantic_map::tile::CurbLine>& curbs, const CurbView& view,
                                        const geo::TangentPlane& plane);

}  // namespace curbstone::map_export
