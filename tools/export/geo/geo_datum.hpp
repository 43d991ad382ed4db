#pragma once

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>
#include <optional>
#include <string>

namespace curbstone::map_export::geo {

/// The position of the map's origin on the Earth and the heading of its x axis.
struct GeoDatum {
  double latitude = 0;   ///< deg, WGS84
  double longitude = 0;  ///< deg, east positive
  double altitude = 0;   ///< m above the ellipsoid (not above sea level)
  double heading = 90;   ///< deg from north, clockwise, of the map's x axis; 90: x east, y north (REP-103)
};

/// Parses "LAT,LON[,ALT[,HEADING]]"; empty if that fails, or if it is not on the Earth.
[[nodiscard]] std::optional<GeoDatum> parse_datum(const std::string& text);

struct GeoPoint {
  double latitude = 0;   ///< deg
  double longitude = 0;  ///< deg, -180 .. 180
  double altitude = 0;   ///< m above the ellipsoid
};

/// Converts the map's frame by the tangent plane of the ellipsoid at the datum: x, y, z to east, north, up, to
/// Earth-centred coordinates, to WGS84 (GeographicLib). Apart from rounding (well below 0.1 mm) that is exact. The
/// remaining errors are that of the datum, and that gravity, which levels the map, differs from the ellipsoid's normal
/// by up to some 0.1 mrad.
class TangentPlane {
 public:
  explicit TangentPlane(const GeoDatum& datum);

  [[nodiscard]] const GeoDatum& datum() const { return datum_; }
  /// m in map -> m east and north of the datum.
  [[nodiscard]] Eigen::Vector2d east_north(double x, double y) const;
  /// m in map -> WGS84.
  [[nodiscard]] GeoPoint to_wgs84(const Eigen::Vector3d& in_map) const;
  /// The plane's x (east), y (north) as a projection, in WKT, which a raster needs for its georeference. Orthographic:
  /// it projects along the plane's normal, so that heights cause no shift.
  [[nodiscard]] std::string wkt() const;

 private:
  GeoDatum datum_;
  GeographicLib::LocalCartesian enu_;  ///< on WGS84, origin at the datum
  Eigen::Matrix2d R_enu_map_;
};

}  // namespace curbstone::map_export::geo
