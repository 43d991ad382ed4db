#include "services/semantic_map/curb_lines/curb_linker.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "services/semantic_map/curb_lines/joints.hpp"

namespace curbstone::semantic_map::curb_lines {

namespace {

constexpr double kGap = 0.80;            // m: gap that is always bridged
constexpr double kFarSideways = 0.10;    // of a longer gap: largest offset of its ends from each other's line
constexpr double kSideways = 0.12;       // m: largest offset of the next point,
constexpr double kSidewaysShare = 0.25;  // plus this share of its distance
constexpr double kAlike = 0.7;           // cosine between the directions of two points
constexpr double kGrid = 2.0;            // m: the longest gap from point to point
constexpr double kJoin = 2.5;            // m: the longest gap from chain to chain
constexpr double kEnd = 1.5;             // m of a chain that determine the direction of its end
constexpr double kJoinSideways = 0.04;   // m: largest offset, plus a share of the gap
constexpr double kJoinShare = 0.04;
constexpr double kJoinAlike = 0.97;   // cosine between the ends' directions
constexpr double kJoinHeight = 0.03;  // m, or a third

/// Spatial index of numbers.
class PlaceGrid {
 public:
  void put(const Eigen::Vector2d& at, std::size_t number) { cells_[cell_of(at)].push_back(number); }
  /// Calls visit(number) for all in the cells up to `reach` cells from that of `at`.
  template <class Visit>
  void around(const Eigen::Vector2d& at, std::int64_t reach, Visit visit) const {
    const Cell centre = cell_of(at);
    for (std::int64_t x = centre.first - reach; x <= centre.first + reach; ++x) {
      for (std::int64_t y = centre.second - reach; y <= centre.second + reach; ++y) {
        const auto it = cells_.find({x, y});
        if (it == cells_.end()) continue;
        for (const std::size_t number : it->second) visit(number);
      }
    }
  }

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;
  static Cell cell_of(const Eigen::Vector2d& at) {
    return {static_cast<std::int64_t>(std::floor(at.x() / kGrid)),
            static_cast<std::int64_t>(std::floor(at.y() / kGrid))};
  }
  std::map<Cell, std::vector<std::size_t>> cells_;
};

/// Links each curb point to the next.
class Linker {
 public:
  explicit Linker(const std::vector<MapCurbPoint>& points) : points_(points), used_(points.size()) {
    for (std::size_t i = 0; i < points.size(); ++i) grid_.put(points[i].foot, i);
  }

  /// Indices along the line through `seed`, which must be unused; marks them used.
  CurbChain follow(std::size_t seed) {
    used_[seed] = true;
    CurbChain line;
    extend(seed, -1, line);
    std::reverse(line.begin(), line.end());
    line.push_back(seed);
    extend(seed, 1, line);
    return line;
  }
  [[nodiscard]] bool is_used(std::size_t i) const { return used_[i]; }

 private:
  void extend(std::size_t from, int sense, CurbChain& line) {
    for (auto next = nearest_ahead(from, sense); next < points_.size(); next = nearest_ahead(next, sense)) {
      used_[next] = true;
      line.push_back(next);
    }
  }
  /// Whether the evidence of two distant points overlaps, and each lies on the other's line.
  static bool bridges(const MapCurbPoint& a, const MapCurbPoint& b) {
    const Eigen::Vector2d d = b.foot - a.foot;
    const double off = std::max(std::abs(d.dot(a.up)), std::abs(d.dot(b.up)));
    return d.norm() < a.reach + b.reach && off < kSideways + kFarSideways * d.norm();
  }
  /// Distance of `b` ahead of `a` (m, plus its sideways offset), if it may be the next point.
  static std::optional<double> step_to(const MapCurbPoint& a, const MapCurbPoint& b, const Eigen::Vector2d& ahead) {
    if (b.up.dot(a.up) < kAlike) return std::nullopt;
    const Eigen::Vector2d d = b.foot - a.foot;
    const double sideways = std::abs(d.dot(a.up));
    if (d.dot(ahead) <= 0 || sideways > kSideways + kSidewaysShare * d.norm()) return std::nullopt;
    if (d.norm() > kGap && !bridges(a, b)) return std::nullopt;
    return d.norm() + sideways;
  }
  /// points_.size() if there is no next point.
  std::size_t nearest_ahead(std::size_t from, int sense) {
    const MapCurbPoint& p = points_[from];
    const Eigen::Vector2d ahead = sense * Eigen::Vector2d(-p.up.y(), p.up.x());
    std::size_t best = points_.size();
    double shortest = kGrid;
    grid_.around(p.foot, 1, [&](std::size_t i) {
      const auto step = used_[i] ? std::nullopt : step_to(p, points_[i], ahead);
      if (!step || *step >= shortest) return;
      best = i;
      shortest = *step;
    });
    return best;
  }

  const std::vector<MapCurbPoint>& points_;
  std::vector<bool> used_;
  PlaceGrid grid_;
};

/// One end of a chain: the straight line through its last metres.
struct ChainEnd {
  Eigen::Vector2d at;         // on that line
  Eigen::Vector2d direction;  // along the chain
  double height = 0;
};

double length(const std::vector<MapCurbPoint>& points, const CurbChain& chain) {
  return (points[chain.back()].foot - points[chain.front()].foot).norm();
}

template <class Iterator>
ChainEnd end_of(const std::vector<MapCurbPoint>& points, Iterator outermost, Iterator inmost) {
  const Eigen::Vector2d tip = points[*outermost].foot;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d up = Eigen::Vector2d::Zero();
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  ChainEnd end;
  double n = 0;
  for (auto it = outermost; it != inmost && (points[*it].foot - tip).norm() <= kEnd; ++it) {
    const Eigen::Vector2d d = points[*it].foot - tip;
    mean += d;
    scatter += d * d.transpose();
    up += points[*it].up;
    end.height += points[*it].height;
    n += 1;
  }
  mean /= n;
  scatter = scatter / n - mean * mean.transpose();
  const double angle = 0.5 * std::atan2(2 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  end.direction = {std::cos(angle), std::sin(angle)};
  if (end.direction.dot(Eigen::Vector2d(-up.y(), up.x())) < 0) end.direction = -end.direction;
  end.at = tip + mean + end.direction * end.direction.dot(-mean);
  end.height /= n;
  return end;
}

/// Distance of two ends, if the second continues the first.
std::optional<double> gap_between(const ChainEnd& from, const ChainEnd& to, double shorter) {
  const Eigen::Vector2d d = to.at - from.at;
  const double gap = d.norm();
  if (gap > std::min(kJoin, shorter) || d.dot(from.direction) <= 0) return std::nullopt;
  if (from.direction.dot(to.direction) < kJoinAlike) return std::nullopt;
  if (std::abs(from.height - to.height) > std::max(kJoinHeight, 0.33 * std::max(from.height, to.height)))
    return std::nullopt;
  const auto off = [&](const ChainEnd& end) { return std::abs(d.x() * end.direction.y() - d.y() * end.direction.x()); };
  if (std::max(off(from), off(to)) > kJoinSideways + kJoinShare * gap) return std::nullopt;
  return gap;
}

/// From the end of one chain to the beginning of another.
std::vector<Joint> find_joints(const std::vector<MapCurbPoint>& points, const std::vector<CurbChain>& chains) {
  PlaceGrid begins;
  for (std::size_t k = 0; k < chains.size(); ++k) begins.put(points[chains[k].front()].foot, k);
  std::vector<Joint> joints;
  for (std::size_t a = 0; a < chains.size(); ++a) {
    const ChainEnd from = end_of(points, chains[a].rbegin(), chains[a].rend());
    begins.around(points[chains[a].back()].foot, 2, [&](std::size_t b) {
      if (a == b) return;
      const double shorter = std::min(length(points, chains[a]), length(points, chains[b]));
      const auto gap = gap_between(from, end_of(points, chains[b].begin(), chains[b].end()), shorter);
      if (gap) joints.push_back({*gap, last_end(a), first_end(b)});
    });
  }
  return joints;
}

/// Joins chains that continue behind a gap.
std::vector<CurbChain> join_chains(const std::vector<MapCurbPoint>& points, std::vector<CurbChain> chains) {
  const std::vector<std::size_t> partner = join_shortest_first(chains.size(), find_joints(points, chains));
  std::vector<CurbChain> joined;
  for (std::size_t k = 0; k < chains.size(); ++k) {
    if (partner[first_end(k)] != kFree) continue;  // it continues another chain
    CurbChain chain = std::move(chains[k]);
    for (std::size_t next = partner[last_end(k)]; next != kFree; next = partner[last_end(piece_of(next))])
      chain.insert(chain.end(), chains[piece_of(next)].begin(), chains[piece_of(next)].end());
    joined.push_back(std::move(chain));
  }
  return joined;
}

}  // namespace

std::vector<CurbChain> chain_curbs(const std::vector<MapCurbPoint>& points) {
  std::vector<CurbChain> chains;
  Linker linker(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!linker.is_used(i)) chains.push_back(linker.follow(i));
  }
  return join_chains(points, std::move(chains));
}

}  // namespace curbstone::semantic_map::curb_lines
