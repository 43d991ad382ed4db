#include "tools/export/geo/geojson_line.hpp"

#include <fmt/format.h>

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace curbstone::map_export::geo {

namespace {

/// A point of the line, and its place beside the plane through the Earth's axis in which the meridians of 0 and 180
/// degrees are.
struct Vertex {
  GeoPoint point;
  double east = 0;   ///< m from the plane, towards 90 deg east
  double front = 0;  ///< m from the axis, along the plane, towards 0 deg
};

Vertex vertex_at(const Eigen::Vector3d& in_map, const TangentPlane& plane) {
  Vertex v{plane.to_wgs84(in_map)};
  double north = 0;
  GeographicLib::Geocentric::WGS84().Forward(v.point.latitude, v.point.longitude, v.point.altitude, v.front, v.east,
                                             north);
  return v;
}

/// East of the meridians of 0 and 180 degrees 1, west -1, on that of 180 (as far as positions are written) 0.
int side_of(const Vertex& v) {
  constexpr double kSame = 5e-6;  // m
  if (v.front < 0 && std::abs(v.east) < kSame) return 0;
  return v.east < 0 ? -1 : 1;
}

/// Where the straight line between two vertices on different sides crosses the 180th meridian, from 0 at `a` to 1 at
/// `b`; empty if it crosses that of 0.
std::optional<double> crossing(const Vertex& a, const Vertex& b) {
  const double t = a.east / (a.east - b.east);
  if (a.front + t * (b.front - a.front) >= 0) return std::nullopt;
  return t;
}

/// The positions, in one part or several.
class Parts {
 public:
  void add(const GeoPoint& p) {
    text_ += fmt::format("{}[{:.10f},{:.10f},{:.4f}]", begins_ ? "" : ",", p.longitude, p.latitude, p.altitude);
    begins_ = false;
  }
  void begin_next() {
    text_ += "],[";
    begins_ = is_cut_ = true;
  }
  [[nodiscard]] std::string geometry() const {
    return is_cut_ ? fmt::format(R"({{"type":"MultiLineString","coordinates":[[{}]]}})", text_)
                   : fmt::format(R"({{"type":"LineString","coordinates":[{}]}})", text_);
  }

 private:
  std::string text_;
  bool begins_ = true;  // of a part
  bool is_cut_ = false;
};

}  // namespace

std::string geojson_line(const std::vector<Eigen::Vector3d>& in_map, const TangentPlane& plane) {
  std::vector<Vertex> line;
  for (const Eigen::Vector3d& point : in_map) line.push_back(vertex_at(point, plane));
  const auto first = std::find_if(line.begin(), line.end(), [](const Vertex& v) { return side_of(v) != 0; });
  int side = first == line.end() ? 1 : side_of(*first);
  Parts parts;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const int next = side_of(line[i]);
    if (next == 0) line[i].point.longitude = side * 180;
    const auto t = next * side < 0 ? crossing(line[i - 1], line[i]) : std::nullopt;
    if (t) {
      GeoPoint cut = plane.to_wgs84(in_map[i - 1] + *t * (in_map[i] - in_map[i - 1]));
      cut.longitude = side * 180;
      if (side_of(line[i - 1]) != 0) parts.add(cut);
      parts.begin_next();
      cut.longitude = -cut.longitude;
      parts.add(cut);
    }
    if (next != 0) side = next;
    parts.add(line[i].point);
  }
  return parts.geometry();
}

}  // namespace curbstone::map_export::geo
