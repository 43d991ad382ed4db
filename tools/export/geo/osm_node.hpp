#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "tools/export/geo/geo_datum.hpp"

namespace curbstone::map_export::geo {

/// A node of Lanelet2's OSM XML; lanelet2_osm() describes its tags. `at`: m in map.
[[nodiscard]] inline std::string osm_node(std::size_t id, const Eigen::Vector3d& at,
                                          const std::optional<TangentPlane>& plane) {
  double elevation = at.z();
  std::string place;
  if (plane) {
    const GeoPoint p = plane->to_wgs84(at);
    place = fmt::format(R"( lat="{:.10f}" lon="{:.10f}")", p.latitude, p.longitude);
    elevation = p.altitude;
  }
  return fmt::format(
      "  <node id=\"{}\" version=\"1\"{}>\n    <tag k=\"local_x\" v=\"{:.4f}\"/>\n    <tag k=\"local_y\" "
      "v=\"{:.4f}\"/>\n"
      "    <tag k=\"ele\" v=\"{:.4f}\"/>\n  </node>\n",
      id, place, at.x(), at.y(), elevation);
}

/// `elements`: nodes, then ways.
[[nodiscard]] inline std::string osm_document(const std::string& elements) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<osm version=\"0.6\" generator=\"curbstone\">\n" + elements +
         "</osm>\n";
}

}  // namespace curbstone::map_export::geo
