#include "services/semantic_map/curb_lines/curb_bridges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace curbstone::semantic_map::curb_lines {

namespace {

constexpr double kMaxGap = 8.0;        // m: a van, or a car with the space before and behind it
constexpr double kSight = 2.0;         // m of a line that determine its direction and height at the end
constexpr double kMinSure = 1.5;       // m, least length of a line
constexpr double kMaxTurn = 0.25;      // rad between a line's end and the chord
constexpr double kUnevenTurns = 0.08;  // rad, largest difference of the two turns: on an arc they are equal
constexpr double kOffArc = 0.10;       // m, further tolerance
constexpr double kAlikeHeight = 0.03;  // m, or a third
constexpr double kTip = 0.7;           // of a line's height that its end must have: otherwise the kerb is lowered there
constexpr double kMinTip = 0.035;      // m
constexpr double kClimb = 0.12;        // of the street
constexpr double kVertices = 0.20;     // m
constexpr double kSeenStep = 0.4;      // of the expected step: a visible step below it is not a curb
constexpr double kMaxFlatLength = 0.45;  // m of the bridge that may visibly have no step: the tips of lines
constexpr double kMinLowered = 1.0;      // m
constexpr double kLowStep = 0.010;       // m
constexpr double kLowSigmas = 3.0;       // of the step along it: its line is known, only its height is not
constexpr double kMaxLowered = 0.06;     // m: higher steps are found without a bridge
constexpr double kBeside = 0.5;          // m: a measured line this close takes precedence

using Cell = std::pair<std::int64_t, std::int64_t>;

Cell cell_at(const Eigen::Vector2d& at) {
  return {static_cast<std::int64_t>(std::floor(at.x() / kBeside)),
          static_cast<std::int64_t>(std::floor(at.y() / kBeside))};
}

Eigen::Vector2d place(const tile::CurbVertex& v) {
  return {double{v.x}, double{v.y}};
}

/// The end of a line: place, direction and height.
struct LineEnd {
  std::size_t line = 0;
  tile::CurbVertex tip;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();  ///< unit, in the line's own direction
  double height = 0;
  bool is_high = false;  ///< neither a lowered kerb, nor lowered at this end
};

/// Evaluated from the tip inwards; nothing if the line is too short.
std::optional<LineEnd> end_of(const std::vector<tile::CurbVertex>& inwards) {
  LineEnd end{.tip = inwards.front(), .at = place(inwards.front())};
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d up = Eigen::Vector2d::Zero();
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  double longest = 0;
  double n = 0;
  for (const tile::CurbVertex& v : inwards) {
    const Eigen::Vector2d d = place(v) - end.at;
    longest = d.norm();
    mean += d;
    scatter += d * d.transpose();
    up += Eigen::Vector2d(double{v.high_side_x}, double{v.high_side_y});
    end.height += double{v.height};
    n += 1;
  }
  end.height /= n;
  if (longest < kMinSure) return std::nullopt;
  end.is_high = double{end.tip.height} >= std::max(kMinTip, kTip * end.height);
  mean /= n;
  scatter = scatter / n - mean * mean.transpose();
  const double angle = 0.5 * std::atan2(2 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  end.along = {std::cos(angle), std::sin(angle)};
  if (end.along.dot(Eigen::Vector2d(-up.y(), up.x())) < 0) end.along = -end.along;
  return end;
}

double turn_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// Whether the second line continues the first, along a straight line or an arc.
bool goes_on(const LineEnd& from, const LineEnd& to) {
  const Eigen::Vector2d chord = to.at - from.at;
  const double gap = chord.norm();
  if (gap < kVertices || gap > kMaxGap) return false;
  const double before = turn_between(from.along, chord);
  const double behind = turn_between(chord, to.along);
  if (std::max(std::abs(before), std::abs(behind)) > kMaxTurn) return false;
  if (std::abs(before - behind) > kUnevenTurns + kOffArc / gap) return false;
  return std::abs(double{from.tip.z} - double{to.tip.z}) < kClimb * gap + kAlikeHeight;
}

bool is_alike(const LineEnd& from, const LineEnd& to) {
  return from.is_high && to.is_high &&
         std::abs(from.height - to.height) <= std::max(kAlikeHeight, std::max(from.height, to.height) / 3);
}

/// Vertices from tip to tip, by a cubic Hermite curve.
std::vector<tile::CurbVertex> bridge_between(const LineEnd& from, const LineEnd& to) {
  const double gap = (to.at - from.at).norm();
  const int pieces = std::max(2, static_cast<int>(std::lround(gap / kVertices)));
  std::vector<tile::CurbVertex> bridge = {from.tip};
  for (int k = 1; k < pieces; ++k) {
    const double s = static_cast<double>(k) / pieces;
    const double s2 = s * s;
    const double s3 = s2 * s;
    const Eigen::Vector2d at = (2 * s3 - 3 * s2 + 1) * from.at + (s3 - 2 * s2 + s) * gap * from.along +
                               (3 * s2 - 2 * s3) * to.at + (s3 - s2) * gap * to.along;
    const Eigen::Vector2d along = ((6 * s2 - 6 * s) * (from.at - to.at) + (3 * s2 - 4 * s + 1) * gap * from.along +
                                   (3 * s2 - 2 * s) * gap * to.along)
                                      .normalized();
    const double z = (1 - s) * double{from.tip.z} + s * double{to.tip.z};
    const double height = (1 - s) * from.height + s * to.height;
    bridge.push_back({static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(z),
                      static_cast<float>(height), static_cast<float>(along.y()), static_cast<float>(-along.x())});
  }
  bridge.push_back(to.tip);
  return bridge;
}

/// Height of the ground seen on one side of a place, at 0.18 to 0.42 m.
std::optional<double> seen_beside(const SeenGround& ground, const Eigen::Vector2d& at, const Eigen::Vector2d& side) {
  double sum = 0;
  int n = 0;
  for (const double off : {0.18, 0.30, 0.42}) {
    if (const auto height = ground(at + off * side)) {
      sum += *height;
      ++n;
    }
  }
  return n > 0 ? std::optional(sum / n) : std::nullopt;
}

/// Whether the ground visibly has no step for longer than the tip of a line.
bool is_contradicted(const SeenGround& ground, const std::vector<tile::CurbVertex>& bridge) {
  int flat = 0;
  for (const tile::CurbVertex& v : bridge) {
    const Eigen::Vector2d up(double{v.high_side_x}, double{v.high_side_y});
    const auto low = seen_beside(ground, place(v), -up);
    const auto high = seen_beside(ground, place(v), up);
    if (low && high && *high - *low < kSeenStep * double{v.height}) ++flat;
  }
  return flat * kVertices > kMaxFlatLength;
}

/// Whether a measured line lies beside the bridge's middle.
bool meets_others(const std::set<Cell>& measured, const std::vector<tile::CurbVertex>& bridge) {
  return std::any_of(bridge.begin(), bridge.end(), [&](const tile::CurbVertex& v) {
    const Eigen::Vector2d at = place(v);
    const double to_ends = std::min((at - place(bridge.front())).norm(), (at - place(bridge.back())).norm());
    return to_ends > 2 * kBeside && measured.contains(cell_at(at));
  });
}

std::optional<tile::CurbLine> line_between(const SeenGround& ground, const std::set<Cell>& measured,
                                           const LineEnd& from, const LineEnd& to) {
  tile::CurbLine line;
  line.points = bridge_between(from, to);
  if (meets_others(measured, line.points)) return std::nullopt;
  if (is_alike(from, to) && !is_contradicted(ground, line.points)) {
    line.inferred = true;
    return line;
  }
  if ((to.at - from.at).norm() < kMinLowered) return std::nullopt;
  const auto step = find_lowered_step(ground, line.points);
  if (!step || step->height < std::max(kLowStep, kLowSigmas * step->sigma) || step->height > kMaxLowered)
    return std::nullopt;
  line.dropped = true;
  for (std::size_t k = 1; k + 1 < line.points.size(); ++k) line.points[k].height = static_cast<float>(step->height);
  return line;
}

struct Bridge {
  double gap = 0;
  std::size_t from = 0, to = 0;  ///< ends
};

/// All possible bridges, the shortest first. An end that another line continues is left out.
std::vector<Bridge> find_bridges(const std::vector<LineEnd>& ends, const std::vector<LineEnd>& begins) {
  std::vector<std::size_t> by_x(begins.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(begins[a].at.x(), a) < std::pair(begins[b].at.x(), b);
  });
  std::vector<Bridge> bridges;
  for (std::size_t e = 0; e < ends.size(); ++e) {
    const double x = ends[e].at.x();
    auto it = std::lower_bound(by_x.begin(), by_x.end(), x - kMaxGap,
                               [&](std::size_t b, double at) { return begins[b].at.x() < at; });
    for (; it != by_x.end() && begins[*it].at.x() <= x + kMaxGap; ++it) {
      if (begins[*it].line == ends[e].line || !goes_on(ends[e], begins[*it])) continue;
      bridges.push_back({(begins[*it].at - ends[e].at).norm(), e, *it});
    }
  }
  std::sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
    return std::tie(a.gap, a.from, a.to) < std::tie(b.gap, b.from, b.to);
  });
  return bridges;
}

/// What may lie between two ends: a curb, or flush kerbstones.
enum class Between { kCurb, kFlush };
enum class Tip { kFirst, kLast };

/// The ends that lines may continue from, and the measured vertices.
class OpenEnds {
 public:
  std::vector<LineEnd> ends;
  std::vector<LineEnd> begins;
  std::set<Cell> measured;

  /// For flush kerbstones, a line shorter than kSight takes its direction with the lines that share its other end; a
  /// line too short for a direction may be the visible part of the stones between two others.
  OpenEnds(const std::vector<tile::CurbLine>& lines, Between between) : lines_(lines) {
    const bool flush = between == Between::kFlush;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (lines[k].points.empty()) continue;
      first_places_.emplace(key_of(lines[k].points.front()), k);
      last_places_.emplace(key_of(lines[k].points.back()), k);
      if (flush && (place(lines[k].points.back()) - place(lines[k].points.front())).norm() < kMinSure) continue;
      for (const tile::CurbVertex& v : lines[k].points) measured.insert(cell_at(place(v)));
    }
    // A line that is cut where the kerb is lowered shares a vertex with its neighbour.
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (lines[k].points.empty()) continue;
      if (!first_places_.contains(key_of(lines[k].points.back()))) take(end_of(inwards(k, Tip::kLast, flush)), k, ends);
      if (!last_places_.contains(key_of(lines[k].points.front())))
        take(end_of(inwards(k, Tip::kFirst, flush)), k, begins);
    }
  }

 private:
  using Place = std::pair<float, float>;
  static Place key_of(const tile::CurbVertex& v) { return {v.x, v.y}; }

  void take(std::optional<LineEnd> end, std::size_t line, std::vector<LineEnd>& all) const {
    if (!end) return;
    end->line = line;
    end->is_high = end->is_high && !lines_[line].dropped;
    all.push_back(*end);
  }
  /// The vertices within kSight of a line's tip, the tip first.
  [[nodiscard]] std::vector<tile::CurbVertex> inwards(std::size_t line, Tip tip, bool through_cuts) const {
    const bool from_last = tip == Tip::kLast;
    std::vector<tile::CurbVertex> vertices;
    for (std::size_t hops = 0; hops <= lines_.size(); ++hops) {
      const std::vector<tile::CurbVertex>& points = lines_[line].points;
      for (std::size_t i = vertices.empty() ? 0 : 1; i < points.size(); ++i) {
        const tile::CurbVertex& v = from_last ? points[points.size() - 1 - i] : points[i];
        if (!vertices.empty() && (place(v) - place(vertices.front())).norm() > kSight) return vertices;
        vertices.push_back(v);
      }
      const auto& others = from_last ? last_places_ : first_places_;
      const auto next = others.find(key_of(from_last ? points.front() : points.back()));
      if (!through_cuts || next == others.end()) break;
      line = next->second;
    }
    return vertices;
  }

  const std::vector<tile::CurbLine>& lines_;
  std::map<Place, std::size_t> first_places_;
  std::map<Place, std::size_t> last_places_;
};

/// Calls `std::optional<tile::CurbLine> make(from, to)` for each pair of ends; an end is used at most once.
template <class Make>
std::vector<tile::CurbLine> bridge(const OpenEnds& open, Make make) {
  std::vector<tile::CurbLine> made;
  std::vector<bool> end_taken(open.ends.size());
  std::vector<bool> begin_taken(open.begins.size());
  for (const Bridge& bridge : find_bridges(open.ends, open.begins)) {
    if (end_taken[bridge.from] || begin_taken[bridge.to]) continue;
    auto line = make(open.ends[bridge.from], open.begins[bridge.to]);
    if (!line) continue;
    end_taken[bridge.from] = begin_taken[bridge.to] = true;
    made.push_back(std::move(*line));
  }
  return made;
}

}  // namespace

void add_bridges(const SeenGround& ground, std::vector<tile::CurbLine>& lines) {
  const OpenEnds open(lines, Between::kCurb);
  std::vector<tile::CurbLine> bridges = bridge(open, [&](const LineEnd& from, const LineEnd& to) {
    auto line = line_between(ground, open.measured, from, to);
    if (line) line->confidence = 0.5F * std::min(lines[from.line].confidence, lines[to.line].confidence);
    return line;
  });
  for (tile::CurbLine& line : bridges) {
    line.id = static_cast<std::int32_t>(lines.size());
    lines.push_back(std::move(line));
  }
}

std::vector<tile::CurbLine> flush_kerbs(const std::vector<tile::CurbLine>& lines) {
  const OpenEnds open(lines, Between::kFlush);
  return bridge(open, [&](const LineEnd& from, const LineEnd& to) -> std::optional<tile::CurbLine> {
    tile::CurbLine line;
    line.points = bridge_between(from, to);
    if (meets_others(open.measured, line.points)) return std::nullopt;
    return line;
  });
}

}  // namespace curbstone::semantic_map::curb_lines
