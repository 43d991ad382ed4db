#include "services/viewer/store/curb_lines.hpp"

#include <algorithm>
#include <cmath>

#include "services/viewer/store/line_lists.hpp"

namespace curbstone {

using viewer::store::is_drawable;
using viewer::store::part_of;

bool is_sound(const curb_line_t& line) {
  const auto n = static_cast<std::size_t>(std::max(0, line.num_points));
  for (const auto* list : {&line.x, &line.y, &line.z, &line.height, &line.high_side_x, &line.high_side_y})
    if (!is_drawable(*list, n)) return false;
  return std::isfinite(line.confidence);
}

bool is_same(const curb_line_t& a, const curb_line_t& b) {
  return a.confidence == b.confidence && a.dropped == b.dropped && a.inferred == b.inferred && a.rise == b.rise &&
         a.x == b.x && a.y == b.y && a.z == b.z && a.height == b.height && a.high_side_x == b.high_side_x &&
         a.high_side_y == b.high_side_y;
}

curb_line_t piece_of(const curb_line_t& line, std::size_t first, std::size_t last) {
  curb_line_t piece = line;
  piece.num_points = static_cast<std::int32_t>(last - first);
  for (auto list : {&curb_line_t::x, &curb_line_t::y, &curb_line_t::z, &curb_line_t::height, &curb_line_t::high_side_x,
                    &curb_line_t::high_side_y})
    piece.*list = part_of(line.*list, first, last);
  return piece;
}

}  // namespace curbstone
