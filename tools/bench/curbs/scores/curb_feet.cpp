#include "tools/bench/curbs/scores/curb_feet.hpp"

#include <cmath>

namespace curbstone::bench::curbs::scores {

std::vector<evaluate::CurbFoot> feet_along(const std::vector<semantic_map::tile::CurbLine>& lines, double spacing) {
  std::vector<evaluate::CurbFoot> feet;
  const auto foot = [](const semantic_map::tile::CurbVertex& a, const semantic_map::tile::CurbVertex& b, double f) {
    const auto mix = [f](float from, float to) { return double{from} + f * (double{to} - double{from}); };
    return evaluate::CurbFoot{{mix(a.x, b.x), mix(a.y, b.y)},
                              {mix(a.high_side_x, b.high_side_x), mix(a.high_side_y, b.high_side_y)}};
  };
  for (const semantic_map::tile::CurbLine& line : lines) {
    if (line.inferred) continue;
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      const semantic_map::tile::CurbVertex& a = line.points[i];
      const semantic_map::tile::CurbVertex& b = line.points[i + 1];
      const int pieces =
          std::max(1, static_cast<int>(std::ceil(std::hypot(double{b.x - a.x}, double{b.y - a.y}) / spacing)));
      for (int k = 0; k < pieces; ++k) feet.push_back(foot(a, b, static_cast<double>(k) / pieces));
    }
    if (!line.points.empty()) feet.push_back(foot(line.points.back(), line.points.back(), 0));
  }
  return feet;
}

}  // namespace curbstone::bench::curbs::scores
