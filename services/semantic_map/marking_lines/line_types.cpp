#include "services/semantic_map/marking_lines/line_types.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

namespace curbstone::semantic_map::marking_lines {
namespace {

using tile::MarkingType;

constexpr double kMinSolid = 4.2;          // m: a longer piece is not a dash
constexpr double kMinSolidOfPieces = 3.0;  // m: a line of pieces with holes
constexpr double kWornShare = 0.8;         // painted, of a line that is worn
constexpr double kDashUneven = 0.4;        // of the median
constexpr double kStopWidth = 0.24;        // m
constexpr double kMinStopLength = 1.5;     // m
constexpr double kMaxStopLength = 15.0;    // m
constexpr double kStopReach = 8.0;         // m from the driven path
constexpr double kStopAcross = 0.5;        // cosine to the path
constexpr double kBlobLength = 1.5;        // m: shorter and as wide as that is an arrow or a letter
constexpr double kBlobWidth = 0.3;         // m
constexpr double kInRhythm = 0.5;          // m by which a gap may differ from the other gaps of the dashes
constexpr double kMinLaneGap = 1.5;        // m between dashes of a lane (Germany 3/1.5, UK 4/2); worn holes are shorter
constexpr double kSureGap = 2.5;           // m: longer than any worn hole
constexpr double kMaxGapRatio = 1.4;       // factor between a gap of dashes and the next one
constexpr double kCutSlack = 0.3;          // m: a part of a piece that is shorter is not cut off

bool is_uniform(const std::vector<double>& values) {
  const double median = median_of(values);
  const auto alike = std::count_if(values.begin(), values.end(),
                                   [&](double v) { return std::abs(v - median) <= kDashUneven * median; });
  return 3 * static_cast<std::size_t>(alike) >= 2 * values.size();
}

/// Whether dashes and gaps repeat. Of four dashes and more the first and last are ignored, as the line may be cut off
/// there.
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

/// Lengths of dashes, and of the open gaps between them, m. A worn hole does not divide a dash.
struct Dashes {
  std::vector<double> lengths, open;
};

Dashes dashes_of(const PieceSequence& sequence, const std::vector<Gap>& gaps, const Stretch& stretch) {
  Dashes dashes{{sequence[stretch.first].length()}, {}};
  for (std::size_t k = stretch.first; k < stretch.last; ++k) {
    const double length = sequence[k + 1].length();
    if (gaps[k].length <= kMaxHoleLength) {
      dashes.lengths.back() += gaps[k].length + length;
      continue;
    }
    dashes.lengths.push_back(length);
    if (gaps[k].kind != Gap::Kind::kHidden) dashes.open.push_back(gaps[k].length);
  }
  return dashes;
}

/// The gaps before and behind a stretch, as far as there are any.
std::vector<Gap> gaps_beside(const std::vector<Gap>& gaps, const Stretch& stretch) {
  std::vector<Gap> beside;
  if (stretch.first > 0) beside.push_back(gaps[stretch.first - 1]);
  if (stretch.last < gaps.size()) beside.push_back(gaps[stretch.last]);
  return beside;
}

/// Whether a single dash has gaps beside it as dashes have. A solid line that begins within such a gap cuts it short.
bool is_lone_dash(double length, const std::vector<Gap>& beside) {
  double longest = 0;
  for (const Gap& gap : beside) {
    if (gap.kind != Gap::Kind::kOpen || gap.length < kMinLaneGap) return false;
    longest = std::max(longest, gap.length);
  }
  return longest >= kSureGap && length <= std::min(kMinSolid, kMaxDashToGap * longest);
}

/// Whether the pieces of a stretch are dashes, judged by the open gaps within it and beside it. Beside a solid line,
/// gaps that are shorter than those between the dashes of a lane are its holes.
bool is_dashed(const PieceSequence& sequence, const std::vector<Gap>& gaps, const Stretch& stretch) {
  const Dashes of_stretch = dashes_of(sequence, gaps, stretch);
  const std::vector<double>& dashes = of_stretch.lengths;
  std::vector<double> open = of_stretch.open;
  if (*std::max_element(dashes.begin(), dashes.end()) > kMaxDashLength) return false;
  const std::vector<Gap> beside = gaps_beside(gaps, stretch);
  if (dashes.size() == 1) return is_lone_dash(dashes.front(), beside);
  const double shortest_gap = beside.empty() ? 0 : kMinLaneGap;
  const auto fit = [&] {
    return !open.empty() && median_of(open) >= shortest_gap && median_of(dashes) <= kMaxDashToGap * median_of(open) &&
           are_periodic(dashes, open);
  };
  if (fit()) return true;
  for (const Gap& gap : beside) {
    if (gap.kind == Gap::Kind::kOpen) open.push_back(gap.length);
  }
  return fit();
}

/// Splits a sequence into stretches that are dashed and stretches that are not. `is_long`: the pieces that are known
/// not to be dashes.
std::vector<Stretch> split_by(const PieceSequence& sequence, const std::vector<Gap>& gaps,
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

/// Handles dashes that turn into a worn line without a long piece. Such a stretch is not periodic as a whole: its
/// pieces that are not among three or more dashes with similar gaps are marked as long.
void mark_worn(const PieceSequence& sequence, const std::vector<Gap>& gaps, const Stretch& stretch,
               std::vector<bool>& is_long) {
  constexpr std::size_t kMinDashes = 3;
  const auto is_gap = [&](std::size_t k) { return gaps[k].kind == Gap::Kind::kOpen && gaps[k].length >= kMinLaneGap; };
  const auto are_alike = [&](std::size_t k) {
    return std::max(gaps[k].length, gaps[k + 1].length) <= kMaxGapRatio * std::min(gaps[k].length, gaps[k + 1].length);
  };
  std::vector<bool> is_dash(sequence.size());
  bool has_dashes = false;
  for (std::size_t first = stretch.first; first < stretch.last;) {
    std::size_t last = first;
    while (last < stretch.last && is_gap(last) && (last == first || are_alike(last - 1))) ++last;
    if (last + 1 - first >= kMinDashes && is_dashed(sequence, gaps, {first, last})) {
      has_dashes = true;
      for (std::size_t k = first; k <= last; ++k) is_dash[k] = true;
    }
    first = std::max(last, first + 1);
  }
  for (std::size_t k = stretch.first; has_dashes && k <= stretch.last; ++k) is_long[k] = !is_dash[k];
}

/// Splits a sequence where dashes meet a solid line; pieces that are not dashes stay with the solid line beside them.
std::vector<Stretch> split_dashed(const PieceSequence& sequence, const std::vector<Gap>& gaps) {
  const std::size_t n = sequence.size();
  const auto is_hole = [&](std::size_t k) { return gaps[k].kind == Gap::Kind::kHole; };
  // A piece that only a worn hole separates from a long piece belongs to the same line.
  std::vector<bool> is_long(n);
  for (std::size_t k = 0; k < n; ++k)
    is_long[k] = sequence[k].length() > kMaxDashLength || (k > 0 && is_long[k - 1] && is_hole(k - 1));
  for (std::size_t k = n - 1; k > 0; --k) is_long[k - 1] = is_long[k - 1] || (is_long[k] && is_hole(k - 1));
  // Where pieces do not repeat, those separated only by holes may together be one long piece.
  for (const Stretch& stretch : split_by(sequence, gaps, is_long)) {
    for (std::size_t first = stretch.first; !stretch.is_dashed && first <= stretch.last;) {
      std::size_t last = first;
      while (last < stretch.last && is_hole(last)) ++last;
      double length = (sequence[last].end_at - sequence[first].begin_at).norm();
      for (std::size_t k = first; length > kMaxDashLength && k <= last; ++k) is_long[k] = true;
      first = last + 1;
    }
  }
  for (const Stretch& stretch : split_by(sequence, gaps, is_long)) {
    if (!stretch.is_dashed && !is_long[stretch.first]) mark_worn(sequence, gaps, stretch, is_long);
  }
  std::vector<Stretch> merged;
  for (const Stretch& stretch : split_by(sequence, gaps, is_long)) {
    if (!merged.empty() && !stretch.is_dashed && !merged.back().is_dashed)
      merged.back().last = stretch.last;
    else
      merged.push_back(stretch);
  }
  return merged;
}

/// A sequence with its stretches.
struct PartedSequence {
  PieceSequence pieces;
  std::vector<Gap> gaps;
  std::vector<Stretch> stretches;

  void reverse() {
    pieces = reversed(pieces);
    std::reverse(gaps.begin(), gaps.end());
    std::reverse(stretches.begin(), stretches.end());
    for (Stretch& stretch : stretches) {
      const std::size_t first = pieces.size() - 1 - stretch.last;
      stretch.last = pieces.size() - 1 - stretch.first;
      stretch.first = first;
    }
  }
  /// Cuts a piece in two at `at` m along it. Both stay in its stretch.
  void cut(std::size_t piece, double at) {
    auto [before, behind] = split(pieces[piece], at);
    pieces[piece] = std::move(before);
    pieces.insert(pieces.begin() + static_cast<std::ptrdiff_t>(piece + 1), std::move(behind));
    gaps.insert(gaps.begin() + static_cast<std::ptrdiff_t>(piece), {0, Gap::Kind::kHole});
    for (Stretch& stretch : stretches) {
      stretch.first += stretch.first > piece ? 1 : 0;
      stretch.last += stretch.last >= piece ? 1 : 0;
    }
  }
};

/// The length of the dash with which the solid line behind a stretch of dashes begins, m; 0: none. There is one if the
/// line begins as far behind the last dash as the dashes are apart: they keep their rhythm up to the solid line.
double abutting_dash(const PartedSequence& parted, const Stretch& dashed) {
  const Gap& to_solid = parted.gaps[dashed.last];
  if (to_solid.kind != Gap::Kind::kOpen || to_solid.length < kMinLaneGap) return 0;
  Dashes dashes = dashes_of(parted.pieces, parted.gaps, dashed);
  if (dashed.first > 0 && parted.gaps[dashed.first - 1].kind == Gap::Kind::kOpen)
    dashes.open.push_back(parted.gaps[dashed.first - 1].length);
  if (dashes.open.empty() || std::abs(median_of(dashes.open) - to_solid.length) > kInRhythm) return 0;
  return median_of(dashes.lengths);
}

/// Moves a dash at the beginning of a solid line to the dashes before it.
void cut_abutting(PartedSequence& parted) {
  for (std::size_t i = 0; i + 1 < parted.stretches.size(); ++i) {
    if (!parted.stretches[i].is_dashed || parted.stretches[i + 1].is_dashed) continue;
    double left = abutting_dash(parted, parted.stretches[i]);
    std::size_t k = parted.stretches[i + 1].first;
    while (left > kCutSlack && k < parted.stretches[i + 1].last && parted.pieces[k].length() < left + kCutSlack &&
           parted.gaps[k].kind == Gap::Kind::kHole) {
      left -= parted.pieces[k].length() + parted.gaps[k].length;
      ++k;
    }
    if (left > kCutSlack) {
      if (parted.pieces[k].length() < left + kCutSlack) continue;
      parted.cut(k, parted.pieces[k].begin + left);
      ++k;
    }
    parted.stretches[i].last = k - 1;
    parted.stretches[i + 1].first = k;
  }
}

/// The type of a stretch. Hidden gaps are no evidence against an unbroken line.
MarkingType type_of(const PieceSequence& sequence, const std::vector<Gap>& gaps, const Stretch& stretch,
                    const tile::DrivenPath& path) {
  const std::vector<double> dashes = lengths_of(sequence, stretch);
  const std::vector<double> all = gaps_within(gaps, stretch, true);
  const double painted = std::accumulate(dashes.begin(), dashes.end(), 0.0);
  const double length = painted + std::accumulate(all.begin(), all.end(), 0.0);
  const double longest = *std::max_element(dashes.begin(), dashes.end());
  const double longest_gap = all.empty() ? 0 : *std::max_element(all.begin(), all.end());
  const bool is_whole = painted >= kWornShare * length || longest_gap <= kMaxHoleLength;
  std::vector<double> widths;
  for (std::size_t k = stretch.first; k <= stretch.last; ++k) widths.push_back(sequence[k].width);
  const MarkingPiece& piece = sequence[stretch.first];
  if (is_whole && median_of(widths) >= kStopWidth && length >= kMinStopLength && length <= kMaxStopLength &&
      lies_across(piece, path))
    return MarkingType::kStopLine;
  const bool is_lone = stretch.is_dashed && dashes_of(sequence, gaps, stretch).lengths.size() == 1;  // worn in two
  if (is_whole && !is_lone && length >= (dashes.size() > 1 ? kMinSolidOfPieces : kMinSolid)) return MarkingType::kSolid;
  if (stretch.is_dashed) return MarkingType::kDashed;
  if (longest >= kMinSolid) return MarkingType::kSolid;  // no dash, however much of the line is hidden
  const bool has_holes = dashes.size() > 1 && median_of(dashes) > kMaxDashToGap * median_of(all);
  if (painted >= 0.6 * length && length >= kMinSolidOfPieces && has_holes) return MarkingType::kSolid;
  if (dashes.size() == 1 && piece.length() < kBlobLength && piece.width > kBlobWidth) return MarkingType::kOther;
  return MarkingType::kUnknown;
}

}  // namespace

std::vector<TypedSequence> type_sequence(const PieceSequence& sequence, const tile::DrivenPath& path,
                                         const SeenGround& is_seen) {
  PartedSequence parted{sequence, gaps_of(sequence, is_seen), {}};
  parted.stretches = split_dashed(parted.pieces, parted.gaps);
  if (parted.stretches.size() > 1) {
    for (int direction = 0; direction < 2; ++direction) {
      cut_abutting(parted);
      parted.reverse();
    }
  }
  std::vector<TypedSequence> typed;
  for (const Stretch& stretch : parted.stretches) {
    const auto at = [&](std::size_t k) { return parted.pieces.begin() + static_cast<std::ptrdiff_t>(k); };
    typed.push_back(
        {PieceSequence(at(stretch.first), at(stretch.last + 1)), type_of(parted.pieces, parted.gaps, stretch, path)});
  }
  return typed;
}

}  // namespace curbstone::semantic_map::marking_lines
