#include "services/semantic_map/curb_lines/curb_rise.hpp"

namespace curbstone::semantic_map::curb_lines {

CurbRise seen_from(const tile::CurbLine& line, const tile::DrivenPath& path) {
  constexpr std::size_t kLooks = 5;
  double votes = 0;
  for (std::size_t k = 0; k < kLooks && !path.empty() && !line.points.empty(); ++k) {
    const tile::CurbVertex& v = line.points[k * (line.points.size() - 1) / (kLooks - 1)];
    const Eigen::Vector2d at(double{v.x}, double{v.y});
    votes += (*path.nearest(at) - at).dot(Eigen::Vector2d(double{v.high_side_x}, double{v.high_side_y})) < 0 ? 1 : -1;
  }
  return votes > 0 ? CurbRise::kUp : votes < 0 ? CurbRise::kDown : CurbRise::kUnknown;
}

}  // namespace curbstone::semantic_map::curb_lines
