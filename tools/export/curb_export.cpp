#include "tools/export/curb_export.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone {

CurbSummary summarise(const CurbLine& line, const CurbView& view) {
  CurbSummary summary;
  std::vector<float> heights;
  for (const CurbVertex& v : line.points) heights.push_back(v.height);
  if (heights.empty()) return summary;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  summary.height = double{*middle};
  summary.is_low = line.dropped || summary.height < view.high_curb;
  double left = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    const CurbVertex& a = line.points[i - 1];
    const CurbVertex& b = line.points[i];
    left += double{b.x - a.x} * double{a.high_side_y + b.high_side_y} -
            double{b.y - a.y} * double{a.high_side_x + b.high_side_x};
  }
  summary.high_side_left = left > 0;
  summary.rise = seen_from(line, view.path);
  return summary;
}

std::string rise_name(CurbRise rise) {
  return rise == CurbRise::kUp ? "up" : rise == CurbRise::kDown ? "down" : "unknown";
}

std::vector<CurbLine> usable_curbs(std::vector<CurbLine> lines) {
  std::erase_if(lines, [](const CurbLine& line) {
    return line.points.size() < 2 || std::any_of(line.points.begin(), line.points.end(), [](const CurbVertex& v) {
             return !(std::abs(v.x) < kFarthestCurb && std::abs(v.y) < kFarthestCurb && std::abs(v.z) < kFarthestCurb);
           });
  });
  return lines;
}

}  // namespace curbstone
