#include "tools/export/curb_export.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::map_export {

CurbSummary summarise(const semantic_map::tile::CurbLine& line, const CurbView& view) {
  CurbSummary summary;
  std::vector<float> heights;
  for (const semantic_map::tile::CurbVertex& v : line.points) heights.push_back(v.height);
  if (heights.empty()) return summary;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  summary.height = double{*middle};
  summary.is_low = line.dropped || summary.height < view.high_curb;
  double left = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    const semantic_map::tile::CurbVertex& a = line.points[i - 1];
    const semantic_map::tile::CurbVertex& b = line.points[i];
    left += double{b.x - a.x} * double{a.high_side_y + b.high_side_y} -
            double{b.y - a.y} * double{a.high_side_x + b.high_side_x};
  }
  summary.high_side_left = left > 0;
  summary.rise = semantic_map::curb_lines::seen_from(line, view.path);
  return summary;
}

std::string rise_name(semantic_map::curb_lines::CurbRise rise) {
  return rise == semantic_map::curb_lines::CurbRise::kUp     ? "up"
         : rise == semantic_map::curb_lines::CurbRise::kDown ? "down"
                                                             : "unknown";
}

std::vector<semantic_map::tile::CurbLine> usable_curbs(std::vector<semantic_map::tile::CurbLine> lines) {
  std::erase_if(lines, [](const semantic_map::tile::CurbLine& line) {
    return line.points.size() < 2 ||
           std::any_of(line.points.begin(), line.points.end(), [](const semantic_map::tile::CurbVertex& v) {
             return !(std::abs(v.x) < kMaxCoordinate && std::abs(v.y) < kMaxCoordinate &&
                      std::abs(v.z) < kMaxCoordinate);
           });
  });
  return lines;
}

}  // namespace curbstone::map_export
