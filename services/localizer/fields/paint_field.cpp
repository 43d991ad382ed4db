#include "services/localizer/fields/paint_field.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::localizer::fields {
namespace {

constexpr double kUsualWidth = 0.12;  // m, of a line whose width the map does not know
constexpr double kMaxPiece = 30;      // m between two vertices: more is damage
constexpr double kDrawnIn = 0.1;      // m, at either end of a dash: both ends then pull, instead of neither

}  // namespace

PaintField::PaintField(const std::vector<semantic_map::tile::MarkingLine>& lines) {
  for (const semantic_map::tile::MarkingLine& line : lines) {
    const double width = line.width > 0 ? double{line.width} : kUsualWidth;
    if (!(width < kMaxPiece)) continue;
    const auto& points = line.points;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Eigen::Vector2d from(points[i].x, points[i].y), to(points[i + 1].x, points[i + 1].y);
      const double length = (to - from).norm();
      if (!points[i].painted || !(length > 0 && length < kMaxPiece)) continue;
      const double drawn_in = std::min(kDrawnIn, 0.4 * length);
      const bool begins = i == 0 || !points[i - 1].painted;
      const bool ends = !points[i + 1].painted || i + 2 == points.size();
      const Eigen::Vector2d along = (to - from) / length;
      const Eigen::Vector2d a = from + (begins ? drawn_in : 0) * along, b = to - (ends ? drawn_in : 0) * along;
      add({0.5 * (a + b), along, 0.5 * (b - a).norm(), 0.5 * width});
    }
  }
}

void PaintField::add(const Rectangle& rectangle) {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(rectangle.half_length + rectangle.half_width + kReach);
  const Eigen::Vector2d low = rectangle.middle - reach, high = rectangle.middle + reach;
  const auto first = tile_at(low.x(), low.y()), last = tile_at(high.x(), high.y());
  if (!first || !last) return;
  for (std::int32_t x = first->x; x <= last->x; ++x) {
    for (std::int32_t y = first->y; y <= last->y; ++y) by_tile_[{x, y}].push_back(rectangle);
  }
}

std::optional<Eigen::Vector2d> PaintField::offset_at(double x, double y) const {
  const auto key = tile_at(x, y);
  const auto there = key ? by_tile_.find(*key) : by_tile_.end();
  if (there == by_tile_.end()) return std::nullopt;
  std::optional<Eigen::Vector2d> nearest;
  double least = kReach * kReach;
  for (const Rectangle& paint : there->second) {
    const Eigen::Vector2d from_middle = Eigen::Vector2d(x, y) - paint.middle;
    const Eigen::Vector2d across(-paint.along.y(), paint.along.x());
    const double u = paint.along.dot(from_middle), v = across.dot(from_middle);
    const double du = u - std::clamp(u, -paint.half_length, paint.half_length);
    const double dv = v - std::clamp(v, -paint.half_width, paint.half_width);
    const double squared = du * du + dv * dv;
    if (squared > least) continue;
    least = squared;
    nearest = du * paint.along + dv * across;
  }
  return nearest;
}

}  // namespace curbstone::localizer::fields
