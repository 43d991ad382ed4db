#include "tools/bench/curbs/curb_feet.hpp"

#include <cmath>

namespace curbstone {

std::vector<CurbFoot> feet_along(const std::vector<CurbLine>& lines, double spacing) {
  std::vector<CurbFoot> feet;
  const auto foot = [](const CurbVertex& a, const CurbVertex& b, double f) {
    const auto mix = [f](float from, float to) { return double{from} + f * (double{to} - double{from}); };
    return CurbFoot{{mix(a.x, b.x), mix(a.y, b.y)},
                    {mix(a.high_side_x, b.high_side_x), mix(a.high_side_y, b.high_side_y)}};
  };
  for (const CurbLine& line : lines) {
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      const CurbVertex& a = line.points[i];
      const CurbVertex& b = line.points[i + 1];
      const int pieces =
          std::max(1, static_cast<int>(std::ceil(std::hypot(double{b.x - a.x}, double{b.y - a.y}) / spacing)));
      for (int k = 0; k < pieces; ++k) feet.push_back(foot(a, b, static_cast<double>(k) / pieces));
    }
    if (!line.points.empty()) feet.push_back(foot(line.points.back(), line.points.back(), 0));
  }
  return feet;
}

}  // namespace curbstone
