#include "services/semantic_map/marking_lines/line_types.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

using tile::MarkingType;

constexpr double kSolid = 4.2;         // m: a longer piece is not a dash
constexpr double kShortSolid = 3.0;    // m: a line of pieces with holes
constexpr double kHole = 0.6;          // m: in a line that is worn
constexpr double kWornShare = 0.8;     // painted, of a line that is worn
constexpr double kDashUneven = 0.4;    // of the median
constexpr double kDashOfGap = 2.2;     // longest dash, in lengths of its gaps: with longer ones the gaps are holes
constexpr double kStopWidth = 0.24;    // m
constexpr double kShortestStop = 1.5;  // m
constexpr double kLongestStop = 15.0;  // m
constexpr double kStopReach = 8.0;     // m from the driven path
constexpr double kStopAcross = 0.5;    // cosine to the path
constexpr double kBlobLength = 1.5;    // m: shorter and as wide as that is an arrow or a letter
constexpr double kBlobWidth = 0.3;     // m
constexpr double kFirstDash = 0.5;     // m: shorter ones are not painted
constexpr double kBreakSlack = 0.4;    // m by which the dash beside a solid line may be longer than the others
constexpr double kBroken = 0.5;        // of a piece's paint: with less it is broken
constexpr double kHalfBreak = 0.1;     // m, about the place where it is
constexpr double kGapAlike = 0.25;     // of a dashed line's gap

/// The ground between two pieces.
struct Gap {
  enum class Kind {
    kHole,    ///< worn paint, within one stroke
    kHidden,  ///< no dark ground was seen in it: nobody knows
    kOpen,    ///< dark ground
  };
  double length = 0;  ///< m
  Kind kind = Kind::kOpen;
};

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

std::vector<Gap> gaps_of(const PieceSequence& sequence, const SeenGround& is_seen) {
  std::vector<Gap> gaps;
  for (std::size_t k = 0; k + 1 < sequence.size(); ++k) {
    const Eigen::Vector2d& from = sequence[k].end_at;
    const Eigen::Vector2d& to = sequence[k + 1].begin_at;
    Gap gap{(to - from).norm()};
    const double shorter = std::min(sequence[k].length(), sequence[k + 1].length());
    if (gap.length <= std::max(kHole, shorter / kDashOfGap))
      gap.kind = Gap::Kind::kHole;
    else if (is_seen && longest_seen(from, to, is_seen) <= kHole)
      gap.kind = Gap::Kind::kHidden;
    gaps.push_back(gap);
  }
  return gaps;
}

bool is_uniform(const std::vector<double>& values) {
  const double median = median_of(values);
  const auto alike = std::count_if(values.begin(), values.end(),
                                   [&](double v) { return std::abs(v - median) <= kDashUneven * median; });
  return 3 * static_cast<std::size_t>(alike) >= 2 * values.size();
}

/// Whether dashes and gaps repeat. Of many dashes the first and last are ignored, for the line may be cut off there.
bool are_periodic(const std::vector<double>& dashes, const std::vector<double>& gaps) {
  const std::vector<double> inner =
      dashes.size() > 3 ? std::vector<double>(dashes.begin() + 1, dashes.end() - 1) : dashes;
  return is_uniform(inner) && is_uniform(gaps);
}

bool lies_across(const MarkingPiece& piece, const tile::DrivenPath& path) {
  const auto way = path.direction_near(piece.middle(), kStopReach);
  return way && std::abs(way->dot(piece.direction())) < kStopAcross;
}

/// Pieces `first` to `last` of a sequence.
struct Stretch {
  std::size_t first = 0, last = 0;
  bool is_dashed = false;
};

std::vector<double> lengths_of(const PieceSequence& sequence, const Stretch& stretch) {
  std::vector<double> lengths;
  for (std::size_t k = stretch.first; k <= stretch.last; ++k) lengths.push_back(sequence[k].length());
  return lengths;
}

std::vector<double> gaps_within(const std::vector<Gap>& gaps, const Stretch& stretch, bool with_hidden) {
  std::vector<double> lengths;
  for (std::size_t k = stretch.first; k < stretch.last; ++k) {
    if (with_hidden || gaps[k].kind != Gap::Kind::kHidden) lengths.push_back(gaps[k].length);
  }
  return lengths;
}

/// Whether the pieces of a stretch are dashes. The open gaps to what is beside it say so, too: a single dash has one on
/// each side.
bool is_dashed(const PieceSequence& sequence, const std::vector<Gap>& gaps, const Stretch& stretch) {
  std::vector<double> dashes = {sequence[stretch.first].length()};
  std::vector<double> open;
  for (std::size_t k = stretch.first; k < stretch.last; ++k) {
    const double length = sequence[k + 1].length();
    if (gaps[k].length <= kHole) {
      dashes.back() += gaps[k].length + length;
      continue;
    }
    dashes.push_back(length);
    if (gaps[k].kind != Gap::Kind::kHidden) open.push_back(gaps[k].length);
  }
  if (*std::max_element(dashes.begin(), dashes.end()) > kLongestDash) return false;
  const auto fit = [&](std::size_t fewest) {
    return open.size() >= fewest && median_of(dashes) <= kDashOfGap * median_of(open) && are_periodic(dashes, open);
  };
  if (fit(1) && dashes.size() > 1) return true;
  const auto add_outer = [&](std::size_t k) {
    if (k < gaps.size() && gaps[k].kind == Gap::Kind::kOpen) open.push_back(gaps[k].length);
  };
  if (stretch.first > 0) add_outer(stretch.first - 1);
  add_outer(stretch.last);
  return fit(dashes.size() > 1 ? 1 : 2);
}

/// Parts a sequence into what is dashed and what is not, where `is_long` says of which pieces it is known that they are
/// no dashes.
std::vector<Stretch> part(const PieceSequence& sequence, const std::vector<Gap>& gaps,
                          const std::vector<bool>& is_long) {
  std::vector<Stretch> stretches;
  for (std::size_t first = 0; first < sequence.size();) {
    std::size_t last = first;
    while (last + 1 < sequence.size() && is_long[last + 1] == is_long[first]) ++last;
    stretches.push_back({first, last});
    stretches.back().is_dashed = !is_long[first] && is_dashed(sequence, gaps, stretches.back());
    first = last + 1;
  }
  return stretches;
}

/// The same. A solid line is parted from dashes; pieces that are no dashes stay with the solid line beside them.
std::vector<Stretch> part(const PieceSequence& sequence, const std::vector<Gap>& gaps) {
  const std::size_t n = sequence.size();
  const auto is_hole = [&](std::size_t k) { return gaps[k].kind == Gap::Kind::kHole; };
  // What a worn hole parts from a long piece is of the same line.
  std::vector<bool> is_long(n);
  for (std::size_t k = 0; k < n; ++k)
    is_long[k] = sequence[k].length() > kLongestDash || (k > 0 && is_long[k - 1] && is_hole(k - 1));
  for (std::size_t k = n - 1; k > 0; --k) is_long[k - 1] = is_long[k - 1] || (is_long[k] && is_hole(k - 1));
  // Where pieces do not repeat, all of those between holes may be one.
  for (const Stretch& stretch : part(sequence, gaps, is_long)) {
    for (std::size_t first = stretch.first; !stretch.is_dashed && first <= stretch.last;) {
      std::size_t last = first;
      while (last < stretch.last && is_hole(last)) ++last;
      double length = (sequence[last].end_at - sequence[first].begin_at).norm();
      for (std::size_t k = first; length > kLongestDash && k <= last; ++k) is_long[k] = true;
      first = last + 1;
    }
  }
  std::vector<Stretch> merged;
  for (const Stretch& stretch : part(sequence, gaps, is_long)) {
    if (!merged.empty() && !stretch.is_dashed && !merged.back().is_dashed)
      merged.back().last = stretch.last;
    else
      merged.push_back(stretch);
  }
  return merged;
}

/// The type of a stretch that is not dashed. Gaps that nobody saw do not say that it is not whole.
MarkingType type_of(const PieceSequence& sequence, const std::vector<Gap>& gaps, const Stretch& stretch,
                    const tile::DrivenPath& path) {
  const std::vector<double> dashes = lengths_of(sequence, stretch);
  const std::vector<double> all = gaps_within(gaps, stretch, true);
  const double painted = std::accumulate(dashes.begin(), dashes.end(), 0.0);
  const double length = painted + std::accumulate(all.begin(), all.end(), 0.0);
  const double longest = *std::max_element(dashes.begin(), dashes.end());
  const double longest_gap = all.empty() ? 0 : *std::max_element(all.begin(), all.end());
  const bool is_whole = painted >= kWornShare * length || longest_gap <= kHole;
  std::vector<double> widths;
  for (std::size_t k = stretch.first; k <= stretch.last; ++k) widths.push_back(sequence[k].width);
  const MarkingPiece& piece = sequence[stretch.first];
  if (is_whole && median_of(widths) >= kStopWidth && length >= kShortestStop && length <= kLongestStop &&
      lies_across(piece, path))
    return MarkingType::kStopLine;
  if (is_whole && length >= (dashes.size() > 1 ? kShortSolid : kSolid)) return MarkingType::kSolid;
  if (stretch.is_dashed) return MarkingType::kDashed;
  if (longest >= kSolid) return MarkingType::kSolid;  // no dash, however much of the line is hidden
  const bool has_holes = dashes.size() > 1 && median_of(dashes) > kDashOfGap * median_of(all);
  if (painted >= 0.6 * length && length >= kShortSolid && has_holes) return MarkingType::kSolid;
  if (dashes.size() == 1 && piece.length() < kBlobLength && piece.width > kBlobWidth) return MarkingType::kOther;
  return MarkingType::kUnknown;
}

}  // namespace

std::vector<TypedSequence> type_sequence(const PieceSequence& sequence, const tile::DrivenPath& path,
                                         const SeenGround& is_seen) {
  const std::vector<Gap> gaps = gaps_of(sequence, is_seen);
  std::vector<TypedSequence> typed;
  for (const Stretch& stretch : part(sequence, gaps)) {
    const auto at = [&](std::size_t k) { return sequence.begin() + static_cast<std::ptrdiff_t>(k); };
    typed.push_back({PieceSequence(at(stretch.first), at(stretch.last + 1)), type_of(sequence, gaps, stretch, path)});
  }
  return typed;
}

}  // namespace curbstone::semantic_map::marking_lines
