#include "tools/export/geo/geo_datum.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace curbstone::map_export::geo {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

std::optional<GeoDatum> parse_datum(const std::string& text) {
  std::array<double, 4> values{0, 0, 0, GeoDatum{}.heading};
  std::size_t count = 0;
  const char* at = text.c_str();
  while (count < values.size()) {
    char* end = nullptr;
    values[count++] = std::strtod(at, &end);
    if (end == at) return std::nullopt;
    at = end;
    if (*at != ',') break;
    ++at;
  }
  if (*at != '\0' || count < 2) return std::nullopt;
  const auto [latitude, longitude, altitude, heading] = values;
  // Negated, so that NaN fails too.
  if (!(std::abs(latitude) <= 90 && std::abs(longitude) <= 180 && std::abs(altitude) <= 1e5 &&
        std::abs(heading) <= 360))
    return std::nullopt;
  return GeoDatum{latitude, longitude, altitude, heading};
}

TangentPlane::TangentPlane(const GeoDatum& datum)
    : datum_(datum), enu_(datum.latitude, datum.longitude, datum.altitude) {
  // Exact zeros for the default heading keep rasters upright.
  const double s = datum.heading == 90 ? 1 : std::sin(datum.heading * kDegree);
  const double c = datum.heading == 90 ? 0 : std::cos(datum.heading * kDegree);
  R_enu_map_ << s, -c, c, s;
}

Eigen::Vector2d TangentPlane::east_north(double x, double y) const {
  return R_enu_map_ * Eigen::Vector2d(x, y);
}

GeoPoint TangentPlane::to_wgs84(const Eigen::Vector3d& in_map) const {
  const Eigen::Vector2d en = east_north(in_map.x(), in_map.y());
  GeoPoint point;
  enu_.Reverse(en.x(), en.y(), in_map.z(), point.latitude, point.longitude, point.altitude);
  return point;
}

std::string TangentPlane::wkt() const {
  return fmt::format(
      R"(PROJCS["curbstone map",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Orthographic"],)"
      R"(PARAMETER["latitude_of_origin",{:.12f}],PARAMETER["central_meridian",{:.12f}],)"
      R"(PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["metre",1],AXIS["Easting",EAST],AXIS["Northing",NORTH]])",
      datum_.latitude, datum_.longitude);
}

}  // namespace curbstone::map_export::geo
