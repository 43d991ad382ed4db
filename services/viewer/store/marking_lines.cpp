#include "services/viewer/store/marking_lines.hpp"

#include <algorithm>
#include <cmath>

#include "services/viewer/store/line_lists.hpp"

namespace curbstone {

using viewer::store::is_drawable;
using viewer::store::part_of;

bool is_sound(const marking_line_t& line) {
  constexpr float kWidest = 100;  // m
  const auto n = static_cast<std::size_t>(std::max(0, line.num_points));
  for (const auto* list : {&line.x, &line.y, &line.z})
    if (!is_drawable(*list, n)) return false;
  return line.painted.size() == n && line.width >= 0 && line.width < kWidest && std::isfinite(line.confidence);
}

bool is_same(const marking_line_t& a, const marking_line_t& b) {
  return a.type == b.type && a.confidence == b.confidence && a.width == b.width && a.x == b.x && a.y == b.y &&
         a.z == b.z && a.painted == b.painted;
}

marking_line_t piece_of(const marking_line_t& line, std::size_t first, std::size_t last) {
  marking_line_t piece = line;
  piece.num_points = static_cast<std::int32_t>(last - first);
  for (auto list : {&marking_line_t::x, &marking_line_t::y, &marking_line_t::z})
    piece.*list = part_of(line.*list, first, last);
  piece.painted = part_of(line.painted, first, last);
  return piece;
}

}  // namespace curbstone
