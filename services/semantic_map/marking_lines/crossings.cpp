#include "services/semantic_map/marking_lines/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "services/semantic_map/marking_lines/piece_sequences.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

constexpr double kMinBarLength = 1.2;    // m
constexpr double kMaxBarLength = 8.0;    // m
constexpr double kMinBarWidth = 0.2;     // m
constexpr double kMinBarCosine = 0.97;   // cosine between bars
constexpr double kMinBarDistance = 0.5;  // m between centres, across the bars
constexpr double kMaxBarDistance = 1.7;  // m
constexpr double kShift = 0.8;           // m, offset along each other
constexpr double kUneven = 0.35;         // of the median distance
constexpr double kBeyond = 0.3;          // m by which paint may extend beyond the ends of the neighbouring bars
constexpr double kWhole = 0.6;           // of the crossing's width: a bar at least this long is complete
constexpr std::size_t kMinBars = 3;

bool is_bar(const MarkingPiece& piece) {
  return piece.length() >= kMinBarLength && piece.length() <= kMaxBarLength && piece.width >= kMinBarWidth &&
         std::abs(piece.begin_direction.dot(piece.end_direction)) > kMinBarCosine;
}

/// Whether two bars lie beside each other as those of a crossing do, `nearest` to `farthest` m across.
bool are_side_by_side(const MarkingPiece& a, const MarkingPiece& b, double nearest, double farthest) {
  const Eigen::Vector2d d = b.middle() - a.middle();
  if (d.norm() > farthest + kShift) return false;
  const Eigen::Vector2d along = a.direction();
  if (std::abs(along.dot(b.direction())) < kMinBarCosine) return false;
  const double across = std::abs(d.x() * along.y() - d.y() * along.x());
  return across >= nearest && across <= farthest && std::abs(d.dot(along)) <= kShift &&
         std::min(a.length(), b.length()) > 0.6 * std::max(a.length(), b.length());
}

/// The bars of a crossing: `across` leads from bar to bar, each from `begin` to `end` along.
struct Crossing {
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();
  Eigen::Vector2d across = Eigen::Vector2d::UnitY();
  double begin = 0, end = 0;   ///< m along, the median of its bars
  double apart = 0;            ///< m from bar to bar; 0: no two bars are neighbours
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
    std::vector<double> gaps;  // without those across a missed bar, which are larger
    for (std::size_t i = 1; i < places.size(); ++i) {
      const double gap = places[i] - places[i - 1];
      if (gap >= kMinBarDistance && gap <= kMaxBarDistance) gaps.push_back(gap);
    }
    begin = median_of(begins);
    end = median_of(ends);
    apart = median_of(gaps);
    refine();
  }

  [[nodiscard]] bool is_even() const {
    std::size_t even = 0;
    for (std::size_t i = 1; i < places.size(); ++i) even += fits(places[i] - places[i - 1]) ? 1U : 0U;
    return 3 * even >= 2 * (places.size() - 1);
  }
  [[nodiscard]] bool has_pace(double gap) const { return std::abs(gap - apart) <= slack(); }
  /// The same, or the gap of two bars with a missed one between them.
  [[nodiscard]] bool fits(double gap) const { return has_pace(gap) || std::abs(gap - 2 * apart) <= slack(); }
  [[nodiscard]] double slack() const { return kUneven * apart; }

  /// Sets `apart` to the mean distance, also over missed bars, because the median of a few gaps has the error of a bar.
  void refine() {
    double distance = 0;
    double steps = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      const double gap = places[i] - places[i - 1];
      if (!fits(gap)) continue;
      distance += gap;
      steps += has_pace(gap) ? 1 : 2;
    }
    if (steps > 0) apart = distance / steps;
  }
  /// Whether a piece lies between `begin` and `end`, with a tolerance of `slack` m.
  [[nodiscard]] bool is_between_ends(const MarkingPiece& piece, double slack) const {
    const auto [from, to] = std::minmax({piece.begin_at.dot(along), piece.end_at.dot(along)});
    return from >= begin - slack && to <= end + slack;
  }
  /// Whether a piece is the next bar, or a missed one of which only a part is seen.
  [[nodiscard]] bool goes_on_with(const MarkingPiece& piece) const {
    if (piece.width < kMinBarWidth || std::abs(piece.direction().dot(along)) < kMinBarCosine ||
        !is_between_ends(piece, kBeyond))
      return false;
    const double place = piece.middle().dot(across);
    const auto next = std::lower_bound(places.begin(), places.end(), place);
    const bool fits_behind = next == places.begin() || fits(place - *(next - 1));
    const bool fits_before = next == places.end() || fits(*next - place);
    return fits_behind && fits_before;
  }
  /// Whether a piece is a bar that was missed between two others.
  [[nodiscard]] bool is_missed_bar(const MarkingPiece& piece) const {
    const double place = piece.middle().dot(across);
    return piece.length() >= kMinBarLength && place > places.front() && place < places.back() && goes_on_with(piece);
  }
  void add(const MarkingPiece& bar) {
    const double place = bar.middle().dot(across);
    places.insert(std::lower_bound(places.begin(), places.end(), place), place);
  }
  /// Whether a piece lies among the bars. Nothing else is painted there, so it is a part of a bar, or was linked
  /// wrongly.
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
    const double from_last = i > 0 ? place(&bar) - place(bars[i - 1]) : 0;
    if (i > 0 && crossing.has_pace(from_last)) gaps.push_back(from_last - (bar.width + bars[i - 1]->width) / 2);
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

/// Disjoint sets of pieces.
class Groups {
 public:
  explicit Groups(std::size_t size) : group_(size), size_(size, 1) { std::iota(group_.begin(), group_.end(), 0); }
  [[nodiscard]] std::size_t first_of(std::size_t i) const {
    while (group_[i] != i) i = group_[i];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    const auto [first, other] = std::minmax({first_of(i), first_of(j)});
    if (first == other) return;
    group_[other] = first;
    size_[first] += size_[other];
  }
  /// Whether it is the first of a group of two or more.
  [[nodiscard]] bool leads(std::size_t i) const { return group_[i] == i && size_[i] > 1; }
  [[nodiscard]] std::vector<std::size_t> of(std::size_t i, const std::vector<std::size_t>& all) const {
    std::vector<std::size_t> members;
    std::copy_if(all.begin(), all.end(), std::back_inserter(members),
                 [&, first = first_of(i)](std::size_t j) { return first_of(j) == first; });
    return members;
  }

 private:
  std::vector<std::size_t> group_, size_;  // size_: of the group that it leads
};

Crossing crossing_of(const std::vector<std::size_t>& members, const std::vector<MarkingPiece>& pieces) {
  std::vector<const MarkingPiece*> bars;
  for (const std::size_t i : members) bars.push_back(&pieces[i]);
  return Crossing(bars);
}

/// Joins a bar, or a group of bars at the same distances, to the group of `first`, if it continues that group beyond a
/// missed bar. The distance is that of neighbours within the group, so bars that all are twice as far apart are not
/// joined: the dashes of two lanes look like that.
bool join_across_missed(std::size_t first, const std::vector<std::size_t>& bars,
                        const std::vector<MarkingPiece>& pieces, Groups& groups) {
  const std::vector<std::size_t> members = groups.of(first, bars);
  const Crossing crossing = crossing_of(members, pieces);
  if (crossing.apart == 0) return false;
  for (const std::size_t j : bars) {
    if (groups.first_of(j) == first) continue;
    const bool is_next = std::any_of(members.begin(), members.end(), [&](std::size_t i) {
      return are_side_by_side(pieces[i], pieces[j], 2 * crossing.apart - crossing.slack(),
                              2 * crossing.apart + crossing.slack());
    });
    if (!is_next) continue;
    const double apart = crossing_of(groups.of(j, bars), pieces).apart;
    if (apart != 0 && !crossing.has_pace(apart)) continue;
    groups.join(first, j);
    return true;
  }
  return false;
}

/// Groups of two or more bars side by side, as indices of pieces.
std::vector<std::vector<std::size_t>> group_bars(const std::vector<MarkingPiece>& pieces) {
  std::vector<std::size_t> bars;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (is_bar(pieces[i])) bars.push_back(i);
  }
  Groups groups(pieces.size());
  for (const std::size_t i : bars) {
    for (const std::size_t j : bars) {
      if (j >= i) break;
      if (are_side_by_side(pieces[i], pieces[j], kMinBarDistance, kMaxBarDistance)) groups.join(i, j);
    }
  }
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (const std::size_t i : bars) {
      while (groups.leads(i) && join_across_missed(i, bars, pieces, groups)) goes_on = true;
    }
  }
  std::vector<std::vector<std::size_t>> found;
  for (const std::size_t i : bars) {
    if (groups.leads(i)) found.push_back(groups.of(i, bars));
  }
  return found;
}

/// How far along a piece it passes a line across the crossing, `end` m along; nothing if not well within the piece.
std::optional<double> passes_at(const MarkingPiece& piece, const Crossing& crossing, double end) {
  constexpr std::size_t kMinSamples = 3;  // of either part
  const auto& samples = piece.samples;
  const auto beyond = [&](std::size_t k) { return samples[k].values.head<2>().dot(crossing.along) - end; };
  for (std::size_t k = kMinSamples; k + kMinSamples < samples.size(); ++k) {
    const double before = beyond(k - 1);
    const double behind = beyond(k);
    if ((before < 0) != (behind < 0))
      return samples[k - 1].s + before / (before - behind) * (samples[k].s - samples[k - 1].s);
  }
  return std::nullopt;
}

/// Cuts missed bars off the lines to which they were linked: such a line continues between two bars, where nothing else
/// is painted.
void cut_out_bars(const Crossing& crossing, double bar_width, std::vector<MarkingPiece>& pieces,
                  std::vector<bool>& taken) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (const double end : {crossing.begin, crossing.end}) {
      if (taken[i] || crossing.is_between_ends(pieces[i], kBeyond)) continue;
      const auto at = passes_at(pieces[i], crossing, end);
      if (!at) continue;
      auto [line, bar] = split(pieces[i], *at);
      if (crossing.is_between_ends(line, kBeyond)) std::swap(line, bar);
      bar.width = bar_width;
      if (!crossing.is_missed_bar(bar)) continue;
      pieces[i] = std::move(line);
      pieces.push_back(std::move(bar));
      taken.push_back(false);
    }
  }
}

}  // namespace

std::vector<tile::MarkingLine> extract_crossings(std::vector<MarkingPiece>& pieces) {
  std::vector<tile::MarkingLine> lines;
  std::vector<bool> taken(pieces.size());
  for (const std::vector<std::size_t>& members : group_bars(pieces)) {
    Crossing crossing = crossing_of(members, pieces);
    if (!crossing.is_even()) continue;
    if (members.size() >= kMinBars) {
      std::vector<double> widths;
      for (const std::size_t i : members) widths.push_back(pieces[i].width);
      cut_out_bars(crossing, median_of(widths), pieces, taken);
    }
    std::vector<const MarkingPiece*> bars;
    std::vector<bool> its(pieces.size());
    const auto take = [&](std::size_t i) {
      bars.push_back(&pieces[i]);
      its[i] = true;
    };
    for (const std::size_t i : members) take(i);
    for (std::size_t before = 0; before < bars.size();) {
      before = bars.size();
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (taken[i] || its[i] || !crossing.goes_on_with(pieces[i])) continue;
        crossing.add(pieces[i]);
        take(i);
      }
    }
    if (bars.size() < kMinBars) continue;
    for (std::size_t i = 0; i < pieces.size(); ++i) taken[i] = taken[i] || its[i] || crossing.holds(pieces[i]);
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
