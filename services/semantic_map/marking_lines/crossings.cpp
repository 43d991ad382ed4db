#include "services/semantic_map/marking_lines/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/semantic_map/marking_lines/piece_sequences.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

constexpr double kShortestBar = 1.2;   // m
constexpr double kLongestBar = 8.0;    // m
constexpr double kNarrowestBar = 0.2;  // m
constexpr double kAlike = 0.97;        // cosine between bars
constexpr double kNearest = 0.5;       // m between centres, across the bars
constexpr double kFarthest = 1.7;      // m
constexpr double kShift = 0.8;         // m, offset along each other
constexpr double kUneven = 0.35;       // of the median distance
constexpr double kBeyond = 0.3;        // m by which paint may extend beyond the ends of the neighbouring bars
constexpr double kWhole = 0.6;         // of the crossing's width: a bar at least this long is complete
constexpr std::size_t kFewestBars = 3;

bool is_bar(const MarkingPiece& piece) {
  return piece.length() >= kShortestBar && piece.length() <= kLongestBar && piece.width >= kNarrowestBar &&
         std::abs(piece.begin_direction.dot(piece.end_direction)) > kAlike;
}

bool are_side_by_side(const MarkingPiece& a, const MarkingPiece& b) {
  if (std::abs(a.direction().dot(b.direction())) < kAlike) return false;
  const Eigen::Vector2d d = b.middle() - a.middle();
  const double along = std::abs(d.dot(a.direction()));
  const double across = std::abs(d.x() * a.direction().y() - d.y() * a.direction().x());
  return across >= kNearest && across <= kFarthest && along <= kShift &&
         std::min(a.length(), b.length()) > 0.6 * std::max(a.length(), b.length());
}

/// The bars of a crossing: `across` leads from bar to bar, each from `begin` to `end` along.
struct Crossing {
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();
  Eigen::Vector2d across = Eigen::Vector2d::UnitY();
  double begin = 0, end = 0;   ///< m along, the median of its bars
  double apart = 0;            ///< m from bar to bar, the median
  std::vector<double> places;  ///< m across, of each bar, sorted

  explicit Crossing(const std::vector<const MarkingPiece*>& bars)
      : along(bars.front()->direction()), across(-along.y(), along.x()) {
    std::vector<double> begins;
    std::vector<double> ends;
    for (const MarkingPiece* bar : bars) {
      const auto [from, to] = std::minmax({bar->begin_at.dot(along), bar->end_at.dot(along)});
      begins.push_back(from);
      ends.push_back(to);
      places.push_back(bar->middle().dot(across));
    }
    std::sort(places.begin(), places.end());
    std::vector<double> gaps;
    for (std::size_t i = 1; i < places.size(); ++i) gaps.push_back(places[i] - places[i - 1]);
    begin = median_of(begins);
    end = median_of(ends);
    apart = median_of(gaps);
  }

  [[nodiscard]] bool is_even() const {
    std::size_t even = 0;
    for (std::size_t i = 1; i < places.size(); ++i) even += has_pace(places[i] - places[i - 1]) ? 1U : 0U;
    return 3 * even >= 2 * (places.size() - 1);
  }
  [[nodiscard]] bool has_pace(double gap) const { return std::abs(gap - apart) <= kUneven * apart; }

  /// Whether a piece lies between `begin` and `end`, with a tolerance of `slack` m.
  [[nodiscard]] bool is_between_ends(const MarkingPiece& piece, double slack) const {
    const auto [from, to] = std::minmax({piece.begin_at.dot(along), piece.end_at.dot(along)});
    return from >= begin - slack && to <= end + slack;
  }
  /// Whether a piece is the next bar, or a missed one of which only a part is seen.
  [[nodiscard]] bool goes_on_with(const MarkingPiece& piece) const {
    if (piece.width < kNarrowestBar || std::abs(piece.direction().dot(along)) < kAlike ||
        !is_between_ends(piece, kBeyond))
      return false;
    const double place = piece.middle().dot(across);
    const auto next = std::lower_bound(places.begin(), places.end(), place);
    const bool fits_behind = next == places.begin() || has_pace(place - *(next - 1));
    const bool fits_before = next == places.end() || has_pace(*next - place);
    return fits_behind && fits_before;
  }
  void add(const MarkingPiece& bar) {
    const double place = bar.middle().dot(across);
    places.insert(std::lower_bound(places.begin(), places.end(), place), place);
  }
  /// Whether a piece is another part of a bar, or was linked from the bars' paint: nothing else is painted there.
  [[nodiscard]] bool holds(const MarkingPiece& piece) const {
    const auto [left, right] = std::minmax({piece.begin_at.dot(across), piece.end_at.dot(across)});
    return is_between_ends(piece, 0) && left >= places.front() - apart / 2 && right <= places.back() + apart / 2;
  }
};

/// Sorts bars across their direction.
tile::MarkingLine line_of(std::vector<const MarkingPiece*> bars, const Crossing& crossing) {
  const auto place = [&](const MarkingPiece* bar) { return bar->middle().dot(crossing.across); };
  std::sort(bars.begin(), bars.end(),
            [&](const MarkingPiece* a, const MarkingPiece* b) { return place(a) < place(b); });
  const double middle = (crossing.begin + crossing.end) / 2;
  std::vector<double> lengths;
  std::vector<double> widths;
  std::vector<double> gaps;
  tile::MarkingLine line;
  line.type = tile::MarkingType::kCrossing;
  double contrast = 0;
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const MarkingPiece& bar = *bars[i];
    widths.push_back(bar.width);
    contrast += bar.contrast / static_cast<double>(bars.size());
    if (i > 0) gaps.push_back(place(&bar) - place(bars[i - 1]) - (bar.width + bars[i - 1]->width) / 2);
    const double z = bar.samples[bar.samples.size() / 2].values.z();
    // The centre of a bar that is seen in part is not the bar's centre.
    const bool is_whole = bar.length() > kWhole * (crossing.end - crossing.begin);
    if (is_whole) lengths.push_back(bar.length());
    const Eigen::Vector2d at = is_whole ? bar.middle() : middle * crossing.along + place(&bar) * crossing.across;
    const Eigen::Vector2d half = 0.5 * bar.width * crossing.across;
    line.points.push_back(vertex(at - half, z, true));
    line.points.push_back(vertex(at + half, z, false));
  }
  line.width = static_cast<float>(median_of(lengths));
  line.dash = static_cast<float>(median_of(widths));
  line.gap = static_cast<float>(median_of(gaps));
  line.confidence = confidence_of(contrast, line.width * static_cast<float>(bars.size()));
  return line;
}

/// Groups of bars side by side, as indices of pieces.
std::vector<std::vector<std::size_t>> group_bars(const std::vector<MarkingPiece>& pieces) {
  std::vector<std::size_t> group(pieces.size());
  std::iota(group.begin(), group.end(), 0);
  const auto first_of = [&](std::size_t i) {
    while (group[i] != i) i = group[i];
    return i;
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!is_bar(pieces[i])) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if ((pieces[j].middle() - pieces[i].middle()).norm() > kFarthest + kShift || !is_bar(pieces[j])) continue;
      if (!are_side_by_side(pieces[i], pieces[j])) continue;
      const std::size_t a = first_of(i);
      const std::size_t b = first_of(j);
      group[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<std::vector<std::size_t>> groups(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) groups[first_of(i)].push_back(i);
  std::erase_if(groups, [](const auto& members) { return members.size() < kFewestBars; });
  return groups;
}

}  // namespace

std::vector<tile::MarkingLine> extract_crossings(std::vector<MarkingPiece>& pieces) {
  std::vector<tile::MarkingLine> lines;
  std::vector<bool> taken(pieces.size());
  for (const std::vector<std::size_t>& members : group_bars(pieces)) {
    std::vector<const MarkingPiece*> bars;
    for (const std::size_t i : members) bars.push_back(&pieces[i]);
    Crossing crossing(bars);
    if (!crossing.is_even()) continue;
    for (const std::size_t i : members) taken[i] = true;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (taken[i]) continue;
      if (crossing.goes_on_with(pieces[i])) {
        crossing.add(pieces[i]);
        bars.push_back(&pieces[i]);
        taken[i] = true;
      }
      if (crossing.holds(pieces[i])) taken[i] = true;
    }
    lines.push_back(line_of(bars, crossing));
  }
  std::vector<MarkingPiece> rest;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!taken[i]) rest.push_back(std::move(pieces[i]));
  }
  pieces = std::move(rest);
  return lines;
}

}  // namespace curbstone::semantic_map::marking_lines
