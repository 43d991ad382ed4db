#include "services/semantic_map/nearby_curbs.hpp"

#include <utility>

#include "services/semantic_map/map_lines.hpp"
#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr std::size_t kMaxVertices = 1800;  // 24 bytes each: below 48 kB
constexpr double kSmaller = 0.7;            // factor on the range if there are more

std::size_t num_vertices(const std::vector<tile::CurbLine>& lines) {
  std::size_t vertices = 0;
  for (const tile::CurbLine& line : lines) vertices += line.points.size() + 1;
  return vertices;
}

}  // namespace

curb_lines_t NearbyCurbs::next(const pipeline::TilePipeline& pipeline, const Eigen::Vector2d& vehicle,
                               const tile::DrivenPath& path) {
  double range = range_;
  const auto box_of = [&] { return MapBox(vehicle.array() - range, vehicle.array() + range); };
  const auto lines_in = [&](const MapBox& box) {
    return link_and_bridge_curbs(curb_points_in(box, pipeline), [&](TileKey key) { return pipeline.classes(key); });
  };
  MapBox box = box_of();
  std::vector<tile::CurbLine> lines = lines_in(box);
  while (num_vertices(lines) > kMaxVertices) {
    range *= kSmaller;
    box = box_of();
    lines = lines_in(box);
  }
  ids_.assign(lines);
  curb_lines_t message;
  for (int axis = 0; axis < 2; ++axis) {
    message.box_min[axis] = static_cast<float>(box.min()[axis]);
    message.box_max[axis] = static_cast<float>(box.max()[axis]);
  }
  message.revision = ++revision_;
  message.num_lines = static_cast<std::int32_t>(lines.size());
  for (const tile::CurbLine& line : lines) message.lines.push_back(to_message(line, path));
  lines_ = std::move(lines);
  return message;
}

}  // namespace curbstone::semantic_map
