#include "services/semantic_map/marking_lines/sequence_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

/// The longest part of a segment along which ground was seen, m. A cell beside it counts: at a distance not every cell
/// is hit.
double longest_seen(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SeenGround& is_seen) {
  const Eigen::Vector2d way = to - from;
  const double length = way.norm();
  const Eigen::Vector2d across = kCellSize * Eigen::Vector2d(-way.y(), way.x()) / std::max(length, 1e-9);
  const int steps = std::max(1, static_cast<int>(std::lround(length / kCellSize)));
  int run = 0;
  int longest = 0;
  for (int k = 0; k < steps; ++k) {
    const Eigen::Vector2d at = from + way * (k + 0.5) / steps;
    run = is_seen(at) || is_seen(at + across) || is_seen(at - across) ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return length * longest / steps;
}

}  // namespace

std::vector<Gap> gaps_of(const PieceSequence& sequence, const SeenGround& is_seen) {
  std::vector<Gap> gaps;
  for (std::size_t k = 0; k + 1 < sequence.size(); ++k) {
    const Eigen::Vector2d& from = sequence[k].end_at;
    const Eigen::Vector2d& to = sequence[k + 1].begin_at;
    Gap gap{(to - from).norm()};
    const double shorter = std::min(sequence[k].length(), sequence[k + 1].length());
    if (gap.length <= std::max(kMaxHoleLength, shorter / kMaxDashToGap))
      gap.kind = Gap::Kind::kHole;
    else if (is_seen && longest_seen(from, to, is_seen) <= kMaxHoleLength)
      gap.kind = Gap::Kind::kHidden;
    gaps.push_back(gap);
  }
  return gaps;
}

}  // namespace curbstone::semantic_map::marking_lines
