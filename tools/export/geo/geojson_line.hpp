#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/export/geo/geo_datum.hpp"

namespace curbstone::map_export::geo {

/// The geometry of a line of two or more points (m in map) in GeoJSON: longitude, latitude (1e-10 deg: 0.01 mm) and m
/// above the ellipsoid. A LineString, or a MultiLineString that is cut at the 180th meridian (RFC 7946, 3.1.9): readers
/// join 179 and -179 deg the long way round the Earth.
[[nodiscard]] std::string geojson_line(const std::vector<Eigen::Vector3d>& in_map, const TangentPlane& plane);

}  // namespace curbstone::map_export::geo
