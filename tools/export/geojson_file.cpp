#include "tools/export/geojson_file.hpp"

#include <fmt/format.h>

#include "tools/export/geo/geojson_line.hpp"

namespace curbstone::map_export {

namespace {

std::string feature(const semantic_map::tile::CurbLine& line, const CurbView& view, const geo::TangentPlane& plane) {
  const CurbSummary summary = summarise(line, view);
  std::vector<Eigen::Vector3d> points;
  for (const semantic_map::tile::CurbVertex& v : line.points) points.emplace_back(v.x, v.y, v.z);
  return fmt::format(
      R"({{"type":"Feature","id":{},"properties":{{"id":{},"subtype":"{}","height":{:.3f},"high_side":"{}","dropped":{},)"
      R"("inferred":{},"confidence":{:.2f},"rise":"{}"}},"geometry":{}}})",
      line.id, line.id, summary.is_low ? "low" : "high", summary.height, summary.high_side_left ? "left" : "right",
      line.dropped, line.inferred, double{line.confidence}, rise_name(summary.rise), geo::geojson_line(points, plane));
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
