#include "tools/export/lanelet2_file.hpp"

#include <fmt/format.h>

#include <iterator>

namespace curbstone::map_export {

namespace {

std::string node(std::size_t id, const semantic_map::tile::CurbVertex& v, const std::optional<TangentPlane>& plane) {
  double elevation = double{v.z};
  std::string place;
  if (plane) {
    const GeoPoint p = plane->to_wgs84({double{v.x}, double{v.y}, double{v.z}});
    place = fmt::format(R"( lat="{:.10f}" lon="{:.10f}")", p.latitude, p.longitude);
    elevation = p.altitude;
  }
  return fmt::format(
      "  <node id=\"{}\" version=\"1\"{}>\n    <tag k=\"local_x\" v=\"{:.4f}\"/>\n    <tag k=\"local_y\" "
      "v=\"{:.4f}\"/>\n"
      "    <tag k=\"ele\" v=\"{:.4f}\"/>\n  </node>\n",
      id, place, double{v.x}, double{v.y}, elevation);
}

std::string way(std::size_t id, std::size_t first_node, const semantic_map::tile::CurbLine& line,
                const CurbView& view) {
  const CurbSummary summary = summarise(line, view);
  std::string text = fmt::format("  <way id=\"{}\" version=\"1\">\n", id);
  for (std::size_t i = 0; i < line.points.size(); ++i) text += fmt::format("    <nd ref=\"{}\"/>\n", first_node + i);
  const auto tag = [&](const char* key, const std::string& value) {
    text += fmt::format("    <tag k=\"{}\" v=\"{}\"/>\n", key, value);
  };
  tag("type", "curbstone");
  tag("subtype", summary.is_low ? "low" : "high");
  tag("height", fmt::format("{:.3f}", summary.height));
  tag("high_side", summary.high_side_left ? "left" : "right");
  if (line.dropped) tag("dropped", "yes");
  if (line.inferred) tag("inferred", "yes");
  if (summary.rise != semantic_map::curb_lines::CurbRise::kUnknown) tag("rise", rise_name(summary.rise));
  tag("confidence", fmt::format("{:.2f}", double{line.confidence}));
  return text + "  </way>\n";
}

}  // namespace

std::string lanelet2_osm(const std::vector<semantic_map::tile::CurbLine>& curbs, const CurbView& view,
                         const std::optional<TangentPlane>& plane) {
  std::string nodes;
  std::string ways;
  std::size_t id = curbs.size();
  for (std::size_t k = 0; k < curbs.size(); ++k) {
    ways += way(k + 1, id + 1, curbs[k], view);
    for (const semantic_map::tile::CurbVertex& v : curbs[k].points) nodes += node(++id, v, plane);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<osm version=\"0.6\" generator=\"curbstone\">\n" + nodes + ways +
         "</osm>\n";
}

}  // namespace curbstone::map_export
