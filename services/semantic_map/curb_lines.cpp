#include "services/semantic_map/curb_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace curbstone {

namespace {

constexpr double kGap = 0.80;          // m that a line may bridge in any case
constexpr double kFarSideways = 0.10;  // of a longer bridge, that its ends may be off each other's line
constexpr double kSideways = 0.12;     // m that the next point may lie off, and a share of its distance
constexpr double kSpacing = 0.15;      // m between vertices
constexpr double kMinLength = 0.50;    // m
constexpr double kGrid = 2.0;          // m: the longest bridge

using Cell = std::pair<std::int64_t, std::int64_t>;

Cell cell_at(double x, double y) {
  return {static_cast<std::int64_t>(std::floor(x / kGrid)), static_cast<std::int64_t>(std::floor(y / kGrid))};
}

/// Follows curb points from one to the next.
class Linker {
 public:
  explicit Linker(const std::vector<MapCurbPoint>& points) : points_(points), used_(points.size()) {
    for (std::size_t i = 0; i < points.size(); ++i)
      cells_[cell_at(points[i].foot.x(), points[i].foot.y())].push_back(i);
  }

  /// Indices along the line through `seed`, which must be unused; marks them used.
  std::vector<std::size_t> follow(std::size_t seed) {
    used_[seed] = true;
    std::vector<std::size_t> line;
    extend(seed, -1, line);
    std::reverse(line.begin(), line.end());
    line.push_back(seed);
    extend(seed, 1, line);
    return line;
  }
  [[nodiscard]] bool is_used(std::size_t i) const { return used_[i]; }

 private:
  void extend(std::size_t from, int sense, std::vector<std::size_t>& line) {
    for (auto next = nearest_ahead(from, sense); next < points_.size(); next = nearest_ahead(next, sense)) {
      used_[next] = true;
      line.push_back(next);
    }
  }
  /// Whether the evidence of two distant points meets, and each lies on the other's line.
  static bool bridges(const MapCurbPoint& a, const MapCurbPoint& b) {
    const Eigen::Vector2d d = b.foot - a.foot;
    const double off = std::max(std::abs(d.dot(a.up)), std::abs(d.dot(b.up)));
    return d.norm() < a.reach + b.reach && off < kSideways + kFarSideways * d.norm();
  }
  /// points_.size() if there is none.
  std::size_t nearest_ahead(std::size_t from, int sense) {
    const MapCurbPoint& p = points_[from];
    const Eigen::Vector2d ahead = sense * Eigen::Vector2d(-p.up.y(), p.up.x());
    std::size_t best = points_.size();
    double best_distance = kGrid;
    const Cell centre = cell_at(p.foot.x(), p.foot.y());
    for (std::int64_t x = centre.first - 1; x <= centre.first + 1; ++x) {
      for (std::int64_t y = centre.second - 1; y <= centre.second + 1; ++y) {
        const auto it = cells_.find({x, y});
        if (it == cells_.end()) continue;
        for (const std::size_t i : it->second) {
          if (used_[i] || points_[i].up.dot(p.up) < 0.7) continue;
          const Eigen::Vector2d d = points_[i].foot - p.foot;
          const double sideways = std::abs(d.dot(p.up));
          if (d.dot(ahead) <= 0 || sideways > kSideways + 0.25 * d.norm()) continue;
          if (d.norm() > kGap && !bridges(p, points_[i])) continue;
          if (d.norm() + sideways < best_distance) {
            best = i;
            best_distance = d.norm() + sideways;
          }
        }
      }
    }
    return best;
  }

  const std::vector<MapCurbPoint>& points_;
  std::vector<bool> used_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

/// The mean of a point and those within 0.3 m along the line.
MapCurbPoint smoothed(const std::vector<MapCurbPoint>& points, const std::vector<std::size_t>& line, std::size_t k) {
  constexpr double kReach = 0.3;
  const MapCurbPoint& centre = points[line[k]];
  MapCurbPoint sum = centre;
  sum.confidence = 0;
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();
  Eigen::Vector2d up = Eigen::Vector2d::Zero();
  double height = 0;
  double z = 0;
  double n = 0;
  // As far on the one side as on the other: the mean of one-sided neighbours would shorten the line's ends.
  for (std::size_t off = 0; off <= std::min(k, line.size() - 1 - k); ++off) {
    const MapCurbPoint& a = points[line[k - off]];
    const MapCurbPoint& b = points[line[k + off]];
    if ((a.foot - centre.foot).norm() > kReach || (b.foot - centre.foot).norm() > kReach) break;
    for (const MapCurbPoint* p : {&a, &b}) {
      foot += p->foot;
      up += p->up;
      height += p->height;
      z += p->z;
      sum.confidence += p->confidence;
      n += 1;
    }
  }
  sum.foot = foot / n;
  sum.up = up.normalized();
  sum.height = height / n;
  sum.z = z / n;
  sum.confidence /= n;
  return sum;
}

CurbLine make_line(const std::vector<MapCurbPoint>& points, const std::vector<std::size_t>& indices) {
  CurbLine line;
  double confidence = 0;
  std::size_t weak = 0;
  Eigen::Vector2d last = Eigen::Vector2d::Constant(1e12);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    if (points[indices[k]].weak) ++weak;
    const MapCurbPoint p = smoothed(points, indices, k);
    confidence += p.confidence;
    if ((p.foot - last).norm() < kSpacing && k + 1 < indices.size()) continue;
    last = p.foot;
    line.points.push_back({static_cast<float>(p.foot.x()), static_cast<float>(p.foot.y()), static_cast<float>(p.z),
                           static_cast<float>(p.height), static_cast<float>(p.up.x()), static_cast<float>(p.up.y())});
  }
  line.confidence = static_cast<float>(confidence / static_cast<double>(indices.size()));
  line.dropped = 2 * weak > indices.size();
  return line;
}

double length(const std::vector<MapCurbPoint>& points, const std::vector<std::size_t>& line) {
  double sum = 0;
  for (std::size_t k = 1; k < line.size(); ++k) sum += (points[line[k]].foot - points[line[k - 1]].foot).norm();
  return sum;
}

}  // namespace

std::vector<CurbLine> link_curbs(const std::vector<MapCurbPoint>& points) {
  std::vector<CurbLine> lines;
  Linker linker(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (linker.is_used(i)) continue;
    const std::vector<std::size_t> indices = linker.follow(i);
    if (length(points, indices) < kMinLength) continue;
    lines.push_back(make_line(points, indices));
    lines.back().id = static_cast<std::int32_t>(lines.size()) - 1;
  }
  return lines;
}

void CurbLineIds::assign(std::vector<CurbLine>& lines) {
  std::map<Cell, std::vector<std::pair<Eigen::Vector2f, std::int32_t>>> before;
  for (const CurbLine& line : before_) {
    for (const CurbVertex& v : line.points) before[cell_at(double{v.x}, double{v.y})].push_back({{v.x, v.y}, line.id});
  }
  std::vector<std::int32_t> taken;
  for (CurbLine& line : lines) {
    std::map<std::int32_t, int> votes;
    for (const CurbVertex& v : line.points) {
      const auto it = before.find(cell_at(double{v.x}, double{v.y}));
      if (it == before.end()) continue;
      for (const auto& [at, id] : it->second) {
        if ((at - Eigen::Vector2f(v.x, v.y)).norm() < 0.3F) ++votes[id];
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

}  // namespace curbstone
