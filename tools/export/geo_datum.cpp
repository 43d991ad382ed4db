#include "tools/export/geo_datum.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace curbstone {

namespace {

// WGS84 (NIMA TR8350.2)
constexpr double kA = 6378137.0;
constexpr double kF = 1 / 298.257223563;
constexpr double kE2 = kF * (2 - kF);
constexpr double kDegree = std::numbers::pi / 180;

Eigen::Vector3d to_ecef(const GeoDatum& at) {
  const double s = std::sin(at.latitude * kDegree);
  const double c = std::cos(at.latitude * kDegree);
  const double n = kA / std::sqrt(1 - kE2 * s * s);
  const double lon = at.longitude * kDegree;
  return {(n + at.altitude) * c * std::cos(lon), (n + at.altitude) * c * std::sin(lon),
          (n * (1 - kE2) + at.altitude) * s};
}

/// By fixed-point iteration: its error falls by e^2 (1/150) a round, so that eight rounds leave nothing near the
/// ground.
GeoPoint to_geodetic(const Eigen::Vector3d& p) {
  const double r = std::hypot(p.x(), p.y());
  double lat = std::atan2(p.z(), r * (1 - kE2));
  double s = 0;
  for (int i = 0; i < 8; ++i) {
    s = std::sin(lat);
    lat = std::atan2(p.z() + kE2 * kA / std::sqrt(1 - kE2 * s * s) * s, r);
  }
  s = std::sin(lat);
  const double altitude = r * std::cos(lat) + p.z() * s - kA * std::sqrt(1 - kE2 * s * s);
  return {lat / kDegree, std::atan2(p.y(), p.x()) / kDegree, altitude};
}

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
  // Written so that NaN fails too.
  if (!(std::abs(latitude) <= 90 && std::abs(longitude) <= 180 && std::abs(altitude) <= 1e5 &&
        std::abs(heading) <= 360))
    return std::nullopt;
  return GeoDatum{latitude, longitude, altitude, heading};
}

TangentPlane::TangentPlane(const GeoDatum& datum) : datum_(datum), origin_(to_ecef(datum)) {
  const double lat = datum.latitude * kDegree;
  const double lon = datum.longitude * kDegree;
  R_ecef_enu_.col(0) << -std::sin(lon), std::cos(lon), 0;
  R_ecef_enu_.col(1) << -std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat);
  R_ecef_enu_.col(2) << std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat);
  // The usual heading shall give exact zeros: rasters stay upright.
  const double s = datum.heading == 90 ? 1 : std::sin(datum.heading * kDegree);
  const double c = datum.heading == 90 ? 0 : std::cos(datum.heading * kDegree);
  R_enu_map_ << s, -c, c, s;
}

Eigen::Vector2d TangentPlane::east_north(double x, double y) const {
  return R_enu_map_ * Eigen::Vector2d(x, y);
}

GeoPoint TangentPlane::to_wgs84(const Eigen::Vector3d& in_map) const {
  const Eigen::Vector2d en = east_north(in_map.x(), in_map.y());
  return to_geodetic(origin_ + R_ecef_enu_ * Eigen::Vector3d(en.x(), en.y(), in_map.z()));
}

std::string TangentPlane::wkt() const {
  return fmt::format(
      R"(PROJCS["curbstone map",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Orthographic"],)"
      R"(PARAMETER["latitude_of_origin",{:.12f}],PARAMETER["central_meridian",{:.12f}],)"
      R"(PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["metre",1],AXIS["Easting",EAST],AXIS["Northing",NORTH]])",
      datum_.latitude, datum_.longitude);
}

}  // namespace curbstone
