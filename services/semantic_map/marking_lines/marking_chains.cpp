#include "services/semantic_map/marking_lines/marking_chains.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/marking_lines/ball_vote.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

constexpr double kVoteSigma = 0.5;      // m, of the vote
constexpr double kMinMass = 1.2;        // a row of single cells has 4 at each place, 2 at its ends
constexpr double kMinStick = 0.25;      // where lines cross there is no direction
constexpr double kAcrossRidge = 0.30;   // m, of the cells that belong to the centre
constexpr double kAlongRidge = 0.30;    // m
constexpr double kRidgeSpacing = 0.10;  // m between ridge points
constexpr double kRidgeGap = 0.90;      // m from one to the next
constexpr double kOffTangent = 0.15;    // m off the line, plus a share of the distance
constexpr double kOffTangentShare = 0.2;
constexpr double kAlikeTangents = 0.75;  // cosine between tangents
constexpr double kArm = 0.8;             // m of a chain on either side of a corner
constexpr double kCorner = 0.7;          // cosine between the two: where lines meet, the vote's tangents turn smoothly
constexpr double kOtherWidth = 2.2;      // factor: along one line the width does not change by as much
constexpr double kBar = 0.35;            // m: bars of crossings are at least as wide
constexpr double kAboutCorner = 0.3;     // m of a chain at a corner that belong to neither side

/// The centre of the paint across the line through `at`.
RidgePoint on_ridge(const MarkingField& field, const Eigen::Vector2d& at, const PlaneVote& vote) {
  const Eigen::Vector2d normal(-vote.tangent.y(), vote.tangent.x());
  RidgePoint point;
  point.at = at;
  point.tangent = vote.tangent;
  point.mass = vote.mass;
  for (int round = 0; round < 2; ++round) {
    double weight = 0;
    double across = 0;
    double z = 0;
    double most = 0;
    field.within(point.at, kAcrossRidge + kAlongRidge, [&](std::size_t j, const Eigen::Vector2d& d) {
      if (std::abs(d.dot(normal)) > kAcrossRidge || std::abs(d.dot(vote.tangent)) > kAlongRidge) return;
      const MapMarkingCell& cell = field.cells()[j];
      const double contrast{cell.contrast};
      weight += contrast;
      across += contrast * d.dot(normal);
      z += contrast * double{cell.z};
      most = std::max(most, contrast);
    });
    if (weight <= 0) break;
    point.at += across / weight * normal;
    point.z = z / weight;
    point.contrast = most;
    point.width = weight * kCellSize * kCellSize / (2 * kAlongRidge * most);
  }
  return point;
}

/// One ridge point each kRidgeSpacing, those with the largest mass first.
std::vector<RidgePoint> thinned(std::vector<RidgePoint> points) {
  std::sort(points.begin(), points.end(), [](const RidgePoint& a, const RidgePoint& b) {
    return std::tuple(-a.mass, a.at.x(), a.at.y()) < std::tuple(-b.mass, b.at.x(), b.at.y());
  });
  std::vector<RidgePoint> kept;
  std::unordered_map<TileKey, std::vector<std::size_t>, TileKeyHash> grid;
  const auto square = [](const Eigen::Vector2d& at) {
    return TileKey{static_cast<std::int32_t>(std::floor(at.x() / kRidgeSpacing)),
                   static_cast<std::int32_t>(std::floor(at.y() / kRidgeSpacing))};
  };
  for (const RidgePoint& p : points) {
    const TileKey centre = square(p.at);
    bool is_free = true;
    for (std::int32_t x = centre.x - 1; x <= centre.x + 1; ++x) {
      for (std::int32_t y = centre.y - 1; y <= centre.y + 1; ++y) {
        const auto it = grid.find({x, y});
        if (it == grid.end()) continue;
        for (const std::size_t i : it->second) is_free = is_free && (kept[i].at - p.at).norm() >= kRidgeSpacing;
      }
    }
    if (!is_free) continue;
    grid[centre].push_back(kept.size());
    kept.push_back(p);
  }
  return kept;
}

/// Links each ridge point to the next.
class RidgeFollower {
 public:
  explicit RidgeFollower(const std::vector<RidgePoint>& points) : points_(points), used_(points.size()) {
    for (std::size_t i = 0; i < points.size(); ++i) grid_[square(points[i].at)].push_back(i);
  }
  [[nodiscard]] bool is_used(std::size_t i) const { return used_[i]; }
  MarkingChain follow(std::size_t seed) {
    used_[seed] = true;
    MarkingChain chain;
    extend(seed, -points_[seed].tangent, chain);
    std::reverse(chain.begin(), chain.end());
    for (RidgePoint& p : chain) p.tangent = -p.tangent;
    chain.push_back(points_[seed]);
    extend(seed, points_[seed].tangent, chain);
    return chain;
  }

 private:
  static TileKey square(const Eigen::Vector2d& at) {
    return {static_cast<std::int32_t>(std::floor(at.x() / kRidgeGap)),
            static_cast<std::int32_t>(std::floor(at.y() / kRidgeGap))};
  }
  void extend(std::size_t from, Eigen::Vector2d ahead, MarkingChain& chain) {
    for (std::size_t next = nearest(from, ahead); next < points_.size(); next = nearest(from, ahead)) {
      used_[next] = true;
      RidgePoint p = points_[next];
      if (p.tangent.dot(ahead) < 0) p.tangent = -p.tangent;
      ahead = p.tangent;
      chain.push_back(p);
      from = next;
    }
  }
  /// points_.size() if there is no next point.
  [[nodiscard]] std::size_t nearest(std::size_t from, const Eigen::Vector2d& ahead) const {
    std::size_t best = points_.size();
    double best_distance = kRidgeGap;
    const TileKey centre = square(points_[from].at);
    for (std::int32_t x = centre.x - 1; x <= centre.x + 1; ++x) {
      for (std::int32_t y = centre.y - 1; y <= centre.y + 1; ++y) {
        const auto it = grid_.find({x, y});
        if (it == grid_.end()) continue;
        for (const std::size_t i : it->second) {
          const RidgePoint& p = points_[i];
          if (used_[i] || std::abs(p.tangent.dot(ahead)) < kAlikeTangents) continue;
          const Eigen::Vector2d d = p.at - points_[from].at;
          const double distance = d.norm();
          const double sideways = std::abs(d.x() * ahead.y() - d.y() * ahead.x());
          if (d.dot(ahead) <= 0 || sideways > kOffTangent + kOffTangentShare * distance) continue;
          if (distance + sideways < best_distance) {
            best = i;
            best_distance = distance + sideways;
          }
        }
      }
    }
    return best;
  }

  const std::vector<RidgePoint>& points_;
  std::vector<bool> used_;
  std::unordered_map<TileKey, std::vector<std::size_t>, TileKeyHash> grid_;
};

/// Arc length of a chain at each of its points, m.
std::vector<double> lengths_along(const MarkingChain& chain) {
  std::vector<double> lengths(chain.size());
  for (std::size_t i = 1; i < chain.size(); ++i) lengths[i] = lengths[i - 1] + (chain[i].at - chain[i - 1].at).norm();
  return lengths;
}

/// Adds a chain to `parts`, cut at its corners, where two lines were linked.
void cut_at_corners(const MarkingChain& chain, std::vector<MarkingChain>& parts) {
  const std::vector<double> lengths = lengths_along(chain);
  double sharpest = kCorner;
  double corner = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (lengths[i] < kArm || lengths.back() - lengths[i] < kArm) continue;
    const auto index_at = [&](double length) {
      const auto it = std::lower_bound(lengths.begin(), lengths.end(), length);
      return std::min(static_cast<std::size_t>(it - lengths.begin()), lengths.size() - 1);
    };
    const Eigen::Vector2d before = chain[i].at - chain[index_at(lengths[i] - kArm)].at;
    const Eigen::Vector2d behind = chain[index_at(lengths[i] + kArm)].at - chain[i].at;
    const double alike = before.normalized().dot(behind.normalized());
    if (alike >= sharpest) continue;
    sharpest = alike;
    corner = lengths[i];
  }
  if (corner == 0) {
    parts.push_back(chain);
    return;
  }
  MarkingChain first;
  MarkingChain second;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (lengths[i] < corner - kAboutCorner) first.push_back(chain[i]);
    if (lengths[i] > corner + kAboutCorner) second.push_back(chain[i]);
  }
  cut_at_corners(first, parts);
  cut_at_corners(second, parts);
}

/// Adds a chain to `parts`, cut where its width changes: there a line was linked to the bar of a crossing.
void cut_at_widths(const MarkingChain& chain, std::vector<MarkingChain>& parts) {
  const std::vector<double> lengths = lengths_along(chain);
  std::vector<double> sums(chain.size() + 1);
  for (std::size_t i = 0; i < chain.size(); ++i) sums[i + 1] = sums[i] + chain[i].width;
  const auto mean_width = [&](std::size_t from, std::size_t to) {
    return (sums[to] - sums[from]) / static_cast<double>(to - from);
  };
  const auto index_at = [&](auto bound) { return static_cast<std::size_t>(bound - lengths.begin()); };
  double most = kOtherWidth;
  std::size_t cut = 0;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    if (lengths[i - 1] < kArm || lengths.back() - lengths[i] < kArm) continue;
    const double before =
        mean_width(index_at(std::lower_bound(lengths.begin(), lengths.end(), lengths[i - 1] - kArm)), i);
    const double behind = mean_width(i, index_at(std::upper_bound(lengths.begin(), lengths.end(), lengths[i] + kArm)));
    const double ratio = std::max(before, behind) / std::max(std::min(before, behind), 1e-3);
    if (std::max(before, behind) < kBar || ratio <= most) continue;
    most = ratio;
    cut = i;
  }
  if (cut == 0) {
    parts.push_back(chain);
    return;
  }
  const auto at = chain.begin() + static_cast<std::ptrdiff_t>(cut);
  cut_at_widths({chain.begin(), at}, parts);
  cut_at_widths({at, chain.end()}, parts);
}

}  // namespace

std::vector<MarkingChain> chain_markings(const MarkingField& field, const ChainOptions& options) {
  std::vector<RidgePoint> ridge;
  for (std::size_t i = 0; i < field.cells().size(); ++i) {
    const MapMarkingCell& cell = field.cells()[i];
    if (!cell.is_strong) continue;
    const PlaneVote vote = vote_in_plane(field, i, kVoteSigma);
    if (options.vote && (vote.mass < kMinMass || vote.stick < kMinStick)) continue;
    ridge.push_back(on_ridge(field, cell.at, vote));
  }
  ridge = thinned(std::move(ridge));
  std::vector<MarkingChain> chains;
  RidgeFollower follower(ridge);
  for (std::size_t i = 0; i < ridge.size(); ++i) {
    if (!follower.is_used(i)) cut_at_corners(follower.follow(i), chains);
  }
  std::vector<MarkingChain> parts;
  for (const MarkingChain& chain : chains) cut_at_widths(chain, parts);
  return parts;
}

}  // namespace curbstone::semantic_map::marking_lines
