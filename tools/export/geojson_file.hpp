#pragma once

#include <string>
#include <vector>

#include "tools/export/curb_export.hpp"
#include "tools/export/geo/geo_datum.hpp"

namespace curbstone::map_export {

/// GeoJSON (RFC 7946): one LineString per curb, longitude, latitude (1e-10 deg: 0.01 mm) and m above the ellipsoid,
/// with id, subtype, height, high_side, dropped, confidence and rise (up, down or unknown, from the driven path). A map
/// across the 180th meridian is not split there.
[[nodiscard]] std::string curbs_geojson(const std::vector<semantic_map::tile::CurbLine>& curbs, const CurbView& view,
                                        const geo::TangentPlane& plane);

}  // namespace curbstone::map_export
