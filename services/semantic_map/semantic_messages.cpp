#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {

curb_line_t to_message(const tile::CurbLine& line, const tile::DrivenPath& path) {
  curb_line_t m;
  m.id = line.id;
  m.confidence = line.confidence;
  m.dropped = line.dropped ? 1 : 0;
  m.inferred = line.inferred ? 1 : 0;
  m.rise = static_cast<std::int8_t>(curb_lines::seen_from(line, path));
  m.num_points = static_cast<std::int32_t>(line.points.size());
  for (const tile::CurbVertex& v : line.points) {
    m.x.push_back(v.x);
    m.y.push_back(v.y);
    m.z.push_back(v.z);
    m.height.push_back(v.height);
    m.high_side_x.push_back(v.high_side_x);
    m.high_side_y.push_back(v.high_side_y);
  }
  return m;
}

marking_line_t to_message(const tile::MarkingLine& line) {
  marking_line_t m;
  m.id = line.id;
  m.type = static_cast<std::int8_t>(line.type);
  m.confidence = line.confidence;
  m.width = line.width;
  m.dash = line.dash;
  m.gap = line.gap;
  m.num_points = static_cast<std::int32_t>(line.points.size());
  for (const tile::MarkingVertex& v : line.points) {
    m.x.push_back(v.x);
    m.y.push_back(v.y);
    m.z.push_back(v.z);
    m.painted.push_back(v.painted ? 1 : 0);
  }
  return m;
}

semantic_tile_t to_message(const tile::MapTile& tile, std::int32_t epoch, std::int32_t revision) {
  semantic_tile_t m;
  m.utime = tile.utime;
  m.curbs_utime = tile.curbs_utime;
  m.epoch = epoch;
  m.tile_x = tile.key.x;
  m.tile_y = tile.key.y;
  m.revision = revision;
  m.z_origin = tile.z_origin;
  for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
    m.cell_class[i] = static_cast<std::uint8_t>(tile.cell_class[i]);
    m.height[i] = tile.height[i];
    m.cost[i] = tile.cost[i];
    m.confidence[i] = tile.confidence[i];
  }
  return m;
}

Pose pose_of(const map_trajectory_t& page, std::size_t i) {
  const std::vector<float>& p = page.positions[i];
  const std::vector<float>& q = page.orientations[i];
  const double position[3] = {p[0], p[1], p[2]};
  const double orientation[4] = {q[0], q[1], q[2], q[3]};
  return pose_from_arrays(position, orientation);
}

}  // namespace curbstone::semantic_map
