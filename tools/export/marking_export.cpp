#include "tools/export/marking_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/export/curb_export.hpp"
#include "tools/export/geo/geojson_line.hpp"
#include "tools/export/geo/osm_node.hpp"

namespace curbstone::map_export {
namespace {

using semantic_map::tile::MarkingLine;
using semantic_map::tile::MarkingType;
using semantic_map::tile::MarkingVertex;

constexpr float kThick = 0.2F;  // m

/// Collects nodes and ways.
class OsmText {
 public:
  explicit OsmText(const std::optional<geo::TangentPlane>& plane) : plane_(plane) {}

  void add_way(const std::vector<MarkingVertex>& points, const std::vector<std::pair<std::string, std::string>>& tags) {
    std::string way = fmt::format("  <way id=\"{}\" version=\"1\">\n", ++id_);
    for (const MarkingVertex& v : points) {
      nodes_ += geo::osm_node(++id_, {double{v.x}, double{v.y}, double{v.z}}, plane_);
      way += fmt::format("    <nd ref=\"{}\"/>\n", id_);
    }
    for (const auto& [key, value] : tags) way += fmt::format("    <tag k=\"{}\" v=\"{}\"/>\n", key, value);
    ways_ += way + "  </way>\n";
  }
  [[nodiscard]] std::string text() const { return geo::osm_document(nodes_ + ways_); }

 private:
  const std::optional<geo::TangentPlane>& plane_;
  std::size_t id_ = 0;
  std::string nodes_;
  std::string ways_;
};

/// The line parallel to another one, `left` m to its left.
std::vector<MarkingVertex> beside(const MarkingLine& line, float left) {
  std::vector<MarkingVertex> moved = line.points;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const MarkingVertex& a = line.points[i == 0 ? 0 : i - 1];
    const MarkingVertex& b = line.points[std::min(i + 1, moved.size() - 1)];
    const float length = std::hypot(b.x - a.x, b.y - a.y);
    if (length <= 0) continue;
    moved[i].x -= left * (b.y - a.y) / length;
    moved[i].y += left * (b.x - a.x) / length;
  }
  return moved;
}

void add_line(const MarkingLine& line, OsmText& osm) {
  std::vector<std::pair<std::string, std::string>> tags;
  const auto metres = [](float value) { return fmt::format("{:.3f}", double{value}); };
  const bool is_crossing = line.type == MarkingType::kCrossing;
  if (is_crossing) {
    tags.emplace_back("type", "pedestrian_marking");
  } else if (line.type == MarkingType::kStopLine) {
    tags.emplace_back("type", "stop_line");
  } else {
    tags.emplace_back("type", line.width < kThick ? "line_thin" : "line_thick");
    if (line.type == MarkingType::kSolid || line.type == MarkingType::kDashed)
      tags.emplace_back("subtype", marking_name(line.type));
  }
  if (line.width > 0) tags.emplace_back("width", metres(line.width));
  if (line.dash > 0) {
    tags.emplace_back("dash", metres(line.dash));
    tags.emplace_back("gap", metres(line.gap));
  }
  tags.emplace_back("confidence", fmt::format("{:.2f}", double{line.confidence}));
  if (!is_crossing) return osm.add_way(line.points, tags);
  for (const float side : {0.5F, -0.5F}) osm.add_way(beside(line, side * line.width), tags);
}

/// Both ends of each painted piece, m along the line.
std::string dashes_of(const MarkingLine& line) {
  std::string text;
  double s = 0;
  bool painted = false;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    if (i > 0)
      s += std::hypot(double{line.points[i].x} - double{line.points[i - 1].x},
                      double{line.points[i].y} - double{line.points[i - 1].y});
    if (line.points[i].painted == painted) continue;
    painted = line.points[i].painted;
    if (painted) text += fmt::format("{}[{:.2f},", text.empty() ? "" : ",", s);
    if (!painted) text += fmt::format("{:.2f}]", s);
  }
  if (painted) text += fmt::format("{:.2f}]", s);
  return "[" + text + "]";
}

}  // namespace

std::string marking_name(MarkingType type) {
  switch (type) {
    case MarkingType::kSolid:
      return "solid";
    case MarkingType::kDashed:
      return "dashed";
    case MarkingType::kStopLine:
      return "stop_line";
    case MarkingType::kCrossing:
      return "crossing";
    case MarkingType::kOther:
      return "other";
    case MarkingType::kUnknown:
      break;
  }
  return "unknown";
}

std::vector<MarkingLine> usable_markings(std::vector<MarkingLine> lines) {
  std::erase_if(lines, [](const MarkingLine& line) {
    return line.points.size() < 2 || std::any_of(line.points.begin(), line.points.end(), [](const MarkingVertex& v) {
             return !(std::abs(v.x) < kMaxCoordinate && std::abs(v.y) < kMaxCoordinate &&
                      std::abs(v.z) < kMaxCoordinate);
           });
  });
  return lines;
}

std::string markings_osm(const std::vector<MarkingLine>& lines, const std::optional<geo::TangentPlane>& plane) {
  OsmText osm(plane);
  for (const MarkingLine& line : lines) add_line(line, osm);
  return osm.text();
}

std::string markings_geojson(const std::vector<MarkingLine>& lines, const geo::TangentPlane& plane) {
  std::string features;
  for (const MarkingLine& line : lines) {
    std::vector<Eigen::Vector3d> points;
    for (const MarkingVertex& v : line.points) points.emplace_back(v.x, v.y, v.z);
    features += fmt::format(
        R"({}{{"type":"Feature","id":{},"properties":{{"id":{},"type":"{}","width":{:.3f},"dash":{:.3f},"gap":{:.3f},)"
        R"("confidence":{:.2f},"dashes":{}}},"geometry":{}}})",
        features.empty() ? "" : ",\n", line.id, line.id, marking_name(line.type), double{line.width}, double{line.dash},
        double{line.gap}, double{line.confidence}, dashes_of(line), geo::geojson_line(points, plane));
  }
  return "{\"type\":\"FeatureCollection\",\"features\":[\n" + features + "\n]}\n";
}

}  // namespace curbstone::map_export
