#include "services/semantic_map/nearby_markings.hpp"

#include <limits>

#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr std::size_t kMaxMarkingVertices = 2200;  // 13 bytes each, 33 a line that has two or more: below 48 kB
constexpr double kSmallerBox = 0.7;                // of the range, where there are more

std::vector<marking_lines::MapMarkingCell> cells_in(const Eigen::Vector2d& min, const Eigen::Vector2d& max,
                                                    const TilePipeline& pipeline) {
  std::vector<marking_lines::MapMarkingCell> cells;
  for (const TileKey& key : pipeline.keys()) {
    const Eigen::Vector2d corner(key.x * kTileSize, key.y * kTileSize);
    if ((corner.array() + kTileSize < min.array()).any() || (corner.array() > max.array()).any()) continue;
    for (const markings::MarkingCell& cell : *pipeline.markings(key)) {
      const Eigen::Vector2d at = corner + Eigen::Vector2d(double{cell.x}, double{cell.y});
      if ((at.array() < min.array()).any() || (at.array() > max.array()).any()) continue;
      cells.push_back({at, double{cell.z}, double{cell.contrast}, cell.is_strong});
    }
  }
  return cells;
}

std::size_t message_size(const std::vector<tile::MarkingLine>& lines) {
  std::size_t vertices = 0;
  for (const tile::MarkingLine& line : lines) vertices += line.points.size() + 1;
  return vertices;
}

}  // namespace

std::vector<tile::MarkingLine> all_markings(const TilePipeline& pipeline, const std::vector<Eigen::Vector2d>& path,
                                            const markings::MarkingParameters& parameters) {
  constexpr double kAll = std::numeric_limits<double>::max();
  return marking_lines::link_markings(
      cells_in(Eigen::Vector2d::Constant(-kAll), Eigen::Vector2d::Constant(kAll), pipeline), path, parameters);
}

marking_lines_t NearbyMarkings::next(const TilePipeline& pipeline, const Eigen::Vector2d& vehicle,
                                     const std::vector<Eigen::Vector2d>& path) {
  double range = range_;
  const auto lines_about = [&] {
    return marking_lines::link_markings(cells_in(vehicle.array() - range, vehicle.array() + range, pipeline), path,
                                        parameters_);
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
