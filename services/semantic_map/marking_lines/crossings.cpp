#include "services/semantic_map/marking_lines/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/semantic_map/marking_lines/marking_strings.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

constexpr double kShortestBar = 1.2;   // m
constexpr double kLongestBar = 8.0;    // m
constexpr double kNarrowestBar = 0.2;  // m
constexpr double kAlike = 0.97;        // cosine between bars
constexpr double kNearest = 0.5;       // m from middle to middle, across
constexpr double kFarthest = 1.7;      // m
constexpr double kShift = 0.8;         // m along each other
constexpr double kUneven = 0.35;       // of the median distance
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

/// Bars in order across them.
tile::MarkingLine line_of(std::vector<const MarkingPiece*> bars) {
  const Eigen::Vector2d along = bars.front()->direction();
  const Eigen::Vector2d across(-along.y(), along.x());
  std::sort(bars.begin(), bars.end(), [&](const MarkingPiece* a, const MarkingPiece* b) {
    return a->middle().dot(across) < b->middle().dot(across);
  });
  std::vector<double> lengths;
  std::vector<double> widths;
  std::vector<double> gaps;
  tile::MarkingLine line;
  line.type = tile::MarkingType::kCrossing;
  double contrast = 0;
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const MarkingPiece& bar = *bars[i];
    lengths.push_back(bar.length());
    widths.push_back(bar.width);
    contrast += bar.contrast / static_cast<double>(bars.size());
    if (i > 0) {
      const double apart = std::abs((bar.middle() - bars[i - 1]->middle()).dot(across));
      gaps.push_back(apart - (bar.width + bars[i - 1]->width) / 2);
    }
    const double z = bar.samples[bar.samples.size() / 2].values.z();
    const Eigen::Vector2d half = 0.5 * bar.width * across;
    line.points.push_back(vertex(bar.middle() - half, z, true));
    line.points.push_back(vertex(bar.middle() + half, z, false));
  }
  line.width = static_cast<float>(median_of(lengths));
  line.dash = static_cast<float>(median_of(widths));
  line.gap = static_cast<float>(median_of(gaps));
  line.confidence = confidence_of(contrast, line.width * static_cast<float>(bars.size()));
  return line;
}

bool is_even(const std::vector<const MarkingPiece*>& bars) {
  const Eigen::Vector2d along = bars.front()->direction();
  const Eigen::Vector2d across(-along.y(), along.x());
  std::vector<double> places;
  for (const MarkingPiece* bar : bars) places.push_back(bar->middle().dot(across));
  std::sort(places.begin(), places.end());
  std::vector<double> apart;
  for (std::size_t i = 1; i < places.size(); ++i) apart.push_back(places[i] - places[i - 1]);
  const double median = median_of(apart);
  const auto even =
      std::count_if(apart.begin(), apart.end(), [&](double d) { return std::abs(d - median) <= kUneven * median; });
  return 3 * static_cast<std::size_t>(even) >= 2 * apart.size();
}

}  // namespace

std::vector<tile::MarkingLine> take_crossings(std::vector<MarkingPiece>& pieces) {
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
  std::vector<tile::MarkingLine> lines;
  std::vector<bool> taken(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (group[i] != i) continue;
    std::vector<const MarkingPiece*> bars;
    std::vector<std::size_t> members;
    for (std::size_t j = i; j < pieces.size(); ++j) {
      if (first_of(j) != i) continue;
      bars.push_back(&pieces[j]);
      members.push_back(j);
    }
    if (bars.size() < kFewestBars || !is_even(bars)) continue;
    lines.push_back(line_of(bars));
    for (const std::size_t j : members) taken[j] = true;
  }
  std::vector<MarkingPiece> rest;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!taken[i]) rest.push_back(std::move(pieces[i]));
  }
  pieces = std::move(rest);
  return lines;
}

}  // namespace curbstone::semantic_map::marking_lines
