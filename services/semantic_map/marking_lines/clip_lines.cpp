#include "services/semantic_map/marking_lines/clip_lines.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace curbstone::semantic_map::marking_lines {
namespace {

using tile::MarkingVertex;

/// The part of the segment between two vertices that lies in the box; 0 and 1 are the vertices.
struct Share {
  double begin = 0;
  double end = 1;
};

/// Liang-Barsky clipping. Nothing if the segment misses the box.
std::optional<Share> share_within(const MarkingVertex& from, const MarkingVertex& to, const Eigen::Vector2d& min,
                                  const Eigen::Vector2d& max) {
  const Eigen::Vector2d begin(double{from.x}, double{from.y});
  const Eigen::Vector2d way = Eigen::Vector2d(double{to.x}, double{to.y}) - begin;
  Share share;
  for (int axis = 0; axis < 2; ++axis) {
    const double low = min[axis] - begin[axis];
    const double high = max[axis] - begin[axis];
    if (way[axis] == 0) {
      if (low > 0 || high < 0) return std::nullopt;
      continue;
    }
    share.begin = std::max(share.begin, std::min(low / way[axis], high / way[axis]));
    share.end = std::min(share.end, std::max(low / way[axis], high / way[axis]));
  }
  if (share.begin >= share.end) return std::nullopt;
  return share;
}

MarkingVertex between(const MarkingVertex& from, const MarkingVertex& to, double share) {
  if (share <= 0) return from;
  if (share >= 1) return to;
  const auto at = [share](float a, float b) { return static_cast<float>(double{a} + share * (double{b} - double{a})); };
  return {.x = at(from.x, to.x), .y = at(from.y, to.y), .z = at(from.z, to.z), .painted = from.painted};
}

void add_parts(const tile::MarkingLine& line, const Eigen::Vector2d& min, const Eigen::Vector2d& max,
               std::vector<tile::MarkingLine>& parts) {
  tile::MarkingLine part = line;
  part.points.clear();
  const auto finish = [&] {
    if (part.points.size() > 1) {
      part.points.back().painted = false;
      parts.push_back(part);
    }
    part.points.clear();
  };
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    const auto share = share_within(line.points[i], line.points[i + 1], min, max);
    if (!share) {
      finish();
      continue;
    }
    if (share->begin > 0) finish();
    if (part.points.empty()) part.points.push_back(between(line.points[i], line.points[i + 1], share->begin));
    part.points.push_back(between(line.points[i], line.points[i + 1], share->end));
    if (share->end < 1) finish();
  }
  finish();
}

}  // namespace

std::vector<tile::MarkingLine> clip_lines(const std::vector<tile::MarkingLine>& lines, const Eigen::Vector2d& min,
                                          const Eigen::Vector2d& max) {
  std::vector<tile::MarkingLine> parts;
  for (const tile::MarkingLine& line : lines) add_parts(line, min, max, parts);
  return parts;
}

}  // namespace curbstone::semantic_map::marking_lines
