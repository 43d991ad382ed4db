#include "tools/export/georeference.hpp"

#include <fmt/format.h>

#include "common/tiles/tile.hpp"

namespace curbstone::map_export {

Georeference::Georeference(const MapGrid& grid, const std::optional<geo::TangentPlane>& plane)
    : first_(grid.left() + 0.5 * kCellSize, grid.top() - 0.5 * kCellSize),
      column_(kCellSize, 0),
      row_(0, -kCellSize),
      wkt_(plane ? plane->wkt() : "") {
  if (!plane) return;
  for (Eigen::Vector2d* v : {&first_, &column_, &row_}) *v = plane->east_north(v->x(), v->y());
}

std::string Georeference::world_file() const {
  std::string lines;
  for (const double value : {column_.x(), column_.y(), row_.x(), row_.y(), first_.x(), first_.y()})
    lines += fmt::format("{:.12f}\n", value);
  return lines;
}

std::optional<std::string> Georeference::projection_file() const {
  if (wkt_.empty()) return std::nullopt;
  return fmt::format("<PAMDataset>\n  <SRS>{}</SRS>\n</PAMDataset>\n", wkt_);
}

}  // namespace curbstone::map_export
