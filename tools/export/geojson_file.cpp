#include "tools/export/geojson_file.hpp"

#include <fmt/format.h>

namespace curbstone::map_export {

namespace {

std::string feature(const semantic_map::tile::CurbLine& line, const CurbView& view, const geo::TangentPlane& plane) {
  const CurbSummary summary = summarise(line, view);
  std::string coordinates;
  for (const semantic_map::tile::CurbVertex& v : line.points) {
    const geo::GeoPoint p = plane.to_wgs84({double{v.x}, double{v.y}, double{v.z}});
    if (!coordinates.empty()) coordinates += ",";
    coordinates += fmt::format("[{:.10f},{:.10f},{:.4f}]", p.longitude, p.latitude, p.altitude);
  }
  return fmt::format(
      R"({{"type":"Feature","id":{},"properties":{{"id":{},"subtype":"{}","height":{:.3f},"high_side":"{}","dropped":{},)"
      R"("inferred":{},"confidence":{:.2f},"rise":"{}"}},"geometry":{{"type":"LineString","coordinates":[{}]}}}})",
      line.id, line.id, summary.is_low ? "low" : "high", summary.height, summary.high_side_left ? "left" : "right",
      line.dropped, line.inferred, double{line.confidence}, rise_name(summary.rise), coordinates);
}

}  // namespace

std::string curbs_geojson(const std::vector<semantic_map::tile::CurbLine>& curbs, const CurbView& view,
                          const geo::TangentPlane& plane) {
  std::string features;
  for (const semantic_map::tile::CurbLine& line : curbs) {
    if (!features.empty()) features += ",\n";
    features += feature(line, view, plane);
  }
  return "{\"type\":\"FeatureCollection\",\"features\":[\n" + features + "\n]}\n";
}

}  // namespace curbstone::map_export
