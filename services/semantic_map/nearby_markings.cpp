#include "services/semantic_map/nearby_markings.hpp"

#include "services/semantic_map/kerbstones.hpp"
#include "services/semantic_map/map_lines.hpp"
#include "services/semantic_map/marking_lines/clip_lines.hpp"
#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr std::size_t kMaxMarkingVertices = 2200;  // 13 bytes each, 33 a line that has two or more: below 48 kB
constexpr double kSmallerBox = 0.7;                // factor on the range if there are more
constexpr double kBeyondBox = 4.0;                 // m of cells beyond the box, for the lines at its edge

std::size_t message_size(const std::vector<tile::MarkingLine>& lines) {
  std::size_t vertices = 0;
  for (const tile::MarkingLine& line : lines) vertices += line.points.size() + 1;
  return vertices;
}

}  // namespace

marking_lines_t NearbyMarkings::next(const pipeline::TilePipeline& pipeline, const std::vector<tile::CurbLine>& curbs,
                                     const Eigen::Vector2d& vehicle, const tile::DrivenPath& path) {
  const Kerbstones kerbs(curbs);
  double range = range_;
  const auto lines_about = [&] {
    const double reach = range + kBeyondBox;
    const MapBox box(vehicle.array() - reach, vehicle.array() + reach);
    const auto linked = link_road_markings(marking_cells_in(box, pipeline), kerbs, path, parameters_,
                                           [&](TileKey key) { return pipeline.classes(key); });
    return marking_lines::clip_lines(linked, vehicle.array() - range, vehicle.array() + range);
  };
  std::vector<tile::MarkingLine> lines = lines_about();
  while (message_size(lines) > kMaxMarkingVertices) {
    range *= kSmallerBox;
    lines = lines_about();
  }
  ids_.assign(lines);
  marking_lines_t message;
  for (int axis = 0; axis < 2; ++axis) {
    message.box_min[axis] = static_cast<float>(vehicle[axis] - range);
    message.box_max[axis] = static_cast<float>(vehicle[axis] + range);
  }
  message.revision = ++revision_;
  message.num_lines = static_cast<std::int32_t>(lines.size());
  for (const tile::MarkingLine& line : lines) message.lines.push_back(to_message(line));
  return message;
}

}  // namespace curbstone::semantic_map
