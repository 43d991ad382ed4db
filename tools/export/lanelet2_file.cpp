#include "tools/export/lanelet2_file.hpp"

#include <fmt/format.h>

#include <iterator>

#include "tools/export/geo/osm_node.hpp"

namespace curbstone::map_export {

namespace {

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
                         const std::optional<geo::TangentPlane>& plane) {
  std::string nodes;
  std::string ways;
  std::size_t id = curbs.size();
  for (std::size_t k = 0; k < curbs.size(); ++k) {
    ways += way(k + 1, id + 1, curbs[k], view);
    for (const semantic_map::tile::CurbVertex& v : curbs[k].points)
      nodes += geo::osm_node(++id, {double{v.x}, double{v.y}, double{v.z}}, plane);
  }
  return geo::osm_document(nodes + ways);
}

}  // namespace curbstone::map_export
