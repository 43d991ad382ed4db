#include "services/semantic_map/curb_lines/curb_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "services/semantic_map/curb_lines/smoothing_spline.hpp"

namespace curbstone::semantic_map::curb_lines {

namespace {

constexpr double kSpacing = 0.20;   // m between vertices
constexpr double kMinLine = 0.50;   // m
constexpr double kLowReach = 0.60;  // m around a place within which the evidence for lowered is collected
constexpr double kMinPiece = 1.0;   // m: shortest lowered or raised piece
constexpr double kCovered = 0.40;   // m around a place without a gap that count as covered
constexpr double kSameCurb = 0.3;   // m: largest distance from the earlier line
constexpr double kSquare = 2.0;     // m

using Square = std::pair<std::int64_t, std::int64_t>;

Square square_at(double x, double y) {
  return {static_cast<std::int64_t>(std::floor(x / kSquare)), static_cast<std::int64_t>(std::floor(y / kSquare))};
}

/// A chain, parametrised by arc length.
struct LaidOut {
  std::vector<SmoothingSpline::Sample> samples;  // by s
  std::vector<const MapCurbPoint*> points;
};

/// Sideways steps add nothing to the length.
LaidOut laid_out(const std::vector<MapCurbPoint>& points, const CurbChain& chain) {
  LaidOut result;
  double s = 0;
  for (const std::size_t i : chain) {
    const MapCurbPoint& p = points[i];
    if (!result.points.empty()) {
      const MapCurbPoint& before = *result.points.back();
      const Eigen::Vector2d up = (before.up + p.up).normalized();
      const Eigen::Vector2d d = p.foot - before.foot;
      s += std::max(0.0, d.y() * up.x() - d.x() * up.y());  // the high side is on the right
    }
    result.points.push_back(&p);
    result.samples.push_back({s, {p.foot.x(), p.foot.y(), p.z, p.height}, std::max(0.05, p.confidence)});
  }
  return result;
}

/// Vertices at equal distances, ends included.
std::vector<double> places_along(const SmoothingSpline& spline) {
  const double length = spline.end() - spline.begin();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / kSpacing - 1e-9)));
  std::vector<double> places;
  for (int k = 0; k <= pieces; ++k) places.push_back(spline.begin() + length * k / pieces);
  return places;
}

/// Whether most of the evidence around each place is of a step lower than a curb's; a bridged part is like the evidence
/// it bridges.
std::vector<bool> lowered(const LaidOut& line, const std::vector<double>& places) {
  std::vector<bool> is_low;
  std::size_t first = 0;
  for (const double s : places) {
    while (first < line.samples.size() && line.samples[first].s < s - kLowReach) ++first;
    int low = 0;
    int all = 0;
    for (std::size_t i = first; i < line.samples.size() && line.samples[i].s <= s + kLowReach; ++i) {
      low += line.points[i]->weak ? 1 : 0;
      ++all;
    }
    is_low.push_back(all > 0 ? 2 * low > all : !is_low.empty() && is_low.back());
  }
  return is_low;
}

/// Ends of the runs of lowered and raised places; a run that is too short is added to the one before it.
std::vector<std::size_t> runs_of(const std::vector<bool>& is_low) {
  const auto least = static_cast<std::size_t>(std::lround(kMinPiece / kSpacing));
  std::vector<std::size_t> ends;
  for (std::size_t k = 1; k <= is_low.size(); ++k) {
    if (k < is_low.size() && is_low[k] == is_low[k - 1]) continue;
    const std::size_t begin = ends.empty() ? 0 : ends.back();
    if (k - begin < least && !ends.empty())
      ends.back() = k;
    else
      ends.push_back(k);
  }
  if (ends.size() > 1 && ends.front() < least) ends.erase(ends.begin());
  return ends;
}

/// Mean confidence of the points from s = from to s = to, times the share of that range that is not bridged.
float confidence_of(const LaidOut& line, double from, double to) {
  double sum = 0;
  double covered = 0;
  double n = 0;
  double reached = from;
  for (const auto& sample : line.samples) {
    if (sample.s < from - 1e-9 || sample.s > to + 1e-9) continue;
    sum += sample.weight;
    n += 1;
    const double low = std::max(reached, sample.s - kCovered);
    const double high = std::min(to, sample.s + kCovered);
    covered += std::max(0.0, high - low);
    reached = std::max(reached, high);
  }
  const double share = to > from ? std::min(1.0, covered / (to - from)) : 1.0;
  return n > 0 ? static_cast<float>(sum / n * share) : 0.0F;
}

tile::CurbVertex vertex_at(const SmoothingSpline& spline, double s) {
  const SmoothingSpline::Values at = spline.at(s);
  const Eigen::Vector2d along = spline.derivative(s).head<2>().normalized();
  return {static_cast<float>(at(0)),     static_cast<float>(at(1)),
          static_cast<float>(at(2)),     std::max(0.001F, static_cast<float>(at(3))),
          static_cast<float>(along.y()), static_cast<float>(-along.x())};
}

/// One line, or several if a kerb is lowered in between: they share the vertices where they meet.
void add_lines(const LaidOut& laid, std::vector<tile::CurbLine>& lines) {
  const SmoothingSpline spline(laid.samples);
  if (spline.end() - spline.begin() < kMinLine) return;
  const std::vector<double> places = places_along(spline);
  const std::vector<bool> is_low = lowered(laid, places);
  std::size_t begin = 0;
  for (const std::size_t end : runs_of(is_low)) {
    const std::size_t last = std::min(end, places.size() - 1);
    tile::CurbLine line;
    std::size_t low = 0;
    for (std::size_t k = begin; k <= last; ++k) {
      line.points.push_back(vertex_at(spline, places[k]));
      if (k < end && is_low[k]) ++low;
    }
    line.dropped = 2 * low > end - begin;
    line.confidence = confidence_of(laid, places[begin], places[last]);
    line.id = static_cast<std::int32_t>(lines.size());
    lines.push_back(std::move(line));
    begin = last;
  }
}

}  // namespace

std::vector<tile::CurbLine> link_curbs(const std::vector<MapCurbPoint>& points) {
  std::vector<tile::CurbLine> lines;
  for (const CurbChain& chain : chain_curbs(points)) add_lines(laid_out(points, chain), lines);
  return lines;
}

void CurbLineIds::assign(std::vector<tile::CurbLine>& lines) {
  std::map<Square, std::vector<std::pair<Eigen::Vector2f, std::int32_t>>> before;
  for (const tile::CurbLine& line : before_) {
    for (const tile::CurbVertex& v : line.points)
      before[square_at(double{v.x}, double{v.y})].push_back({{v.x, v.y}, line.id});
  }
  std::vector<std::int32_t> taken;
  for (tile::CurbLine& line : lines) {
    std::map<std::int32_t, int> votes;
    for (const tile::CurbVertex& v : line.points) {
      const auto it = before.find(square_at(double{v.x}, double{v.y}));
      if (it == before.end()) continue;
      for (const auto& [at, id] : it->second) {
        if ((at - Eigen::Vector2f(v.x, v.y)).norm() < static_cast<float>(kSameCurb)) ++votes[id];
      }
    }
    const auto best =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const bool known = best != votes.end() && std::find(taken.begin(), taken.end(), best->first) == taken.end();
    line.id = known ? best->first : next_++;
    taken.push_back(line.id);
  }
  before_ = lines;
}

}  // namespace curbstone::semantic_map::curb_lines
