#include "tools/evaluate/curb_score.hpp"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/place_grid.hpp"

namespace curbstone {

namespace {

constexpr double kBucket = 1.0;        // m
constexpr double kJoin = 0.5;          // m
constexpr double kLateralReach = 0.5;  // m: farther off is a false detection, not a lateral error

double distance_to_segment(Place p, Place a, Place b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

double percentile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace

TrueCurbs::TrueCurbs(const std::vector<TrueCurbPoint>& points) {
  if (points.empty()) return;
  const auto [low_x, high_x] =
      std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [low_y, high_y] =
      std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.y < b.y; });
  min_x_ = low_x->x;
  min_y_ = low_y->y;
  columns_ = static_cast<int>((high_x->x - min_x_) / kBucket) + 1;
  rows_ = static_cast<int>((high_y->y - min_y_) / kBucket) + 1;
  buckets_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (std::size_t i = 0; i < points.size(); ++i) {
    Segment segment{{points[i].x, points[i].y}, {points[i].x, points[i].y}, points[i].dropped};
    if (i + 1 < points.size() && points[i + 1].line == points[i].line && points[i + 1].dropped == points[i].dropped &&
        std::hypot(points[i + 1].x - points[i].x, points[i + 1].y - points[i].y) <= kJoin) {
      segment.b = {points[i + 1].x, points[i + 1].y};
    }
    const int column = static_cast<int>((segment.a.x - min_x_) / kBucket);
    const int row = static_cast<int>((segment.a.y - min_y_) / kBucket);
    buckets_[static_cast<std::size_t>(row * columns_ + column)].push_back(segment);
  }
}

TrueCurbs::Nearest TrueCurbs::nearest(Place place, double reach) const {
  Nearest nearest;
  if (buckets_.empty()) return nearest;
  const double span = reach + kJoin;  // a segment lies in the bucket of its first end
  const int first_column = std::max(0, static_cast<int>(std::floor((place.x - span - min_x_) / kBucket)));
  const int last_column = std::min(columns_ - 1, static_cast<int>(std::floor((place.x + span - min_x_) / kBucket)));
  const int first_row = std::max(0, static_cast<int>(std::floor((place.y - span - min_y_) / kBucket)));
  const int last_row = std::min(rows_ - 1, static_cast<int>(std::floor((place.y + span - min_y_) / kBucket)));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      for (const Segment& segment : buckets_[static_cast<std::size_t>(row * columns_ + column)]) {
        const double distance = distance_to_segment(place, segment.a, segment.b);
        if (distance > reach) continue;
        double& best = segment.dropped ? nearest.dropped : nearest.distance;
        best = std::min(best, distance);
      }
    }
  }
  return nearest;
}

CurbScore score_curbs(const CurbMap& map, const std::vector<TrueCurbPoint>& truth, const std::vector<Place>& path,
                      double radius) {
  CurbScore score;
  const PlaceGrid<Place> near_path(path, radius);
  const TrueCurbs curbs(truth);

  std::array<int, kTolerances.size()> right{};
  for (const Place& cell : map.cells) {
    if (!near_path.any_near(cell.x, cell.y)) continue;
    const auto nearest = curbs.nearest(cell, kLateralReach);
    if (nearest.distance > kTolerances.back() && nearest.dropped <= kLateralReach) {
      ++score.on_dropped;
      continue;
    }
    ++score.detections;
    for (std::size_t i = 0; i < kTolerances.size(); ++i) right[i] += nearest.distance <= kTolerances[i] ? 1 : 0;
  }

  const PlaceGrid<Place> seen(map.seen, kTolerances.back());
  std::array<int, kTolerances.size()> found{};
  int seen_points = 0;
  for (std::size_t i = 0; i < kTolerances.size(); ++i) {
    const PlaceGrid<Place> cells(map.cells, kTolerances[i]);
    for (const TrueCurbPoint& point : truth) {
      if (point.dropped || !near_path.any_near(point.x, point.y)) continue;
      found[i] += cells.any_near(point.x, point.y) ? 1 : 0;
      if (i == 0) {
        ++score.true_points;
        seen_points += seen.any_near(point.x, point.y) ? 1 : 0;
      }
    }
  }
  for (std::size_t i = 0; i < kTolerances.size(); ++i) {
    score.at[i].precision = score.detections > 0 ? static_cast<double>(right[i]) / score.detections : 0;
    score.at[i].recall = score.true_points > 0 ? static_cast<double>(found[i]) / score.true_points : 0;
  }
  score.recall_of_seen = seen_points > 0 ? static_cast<double>(found.back()) / seen_points : 0;

  std::vector<double> lateral_cm;
  for (const Place& foot : map.feet) {
    if (!near_path.any_near(foot.x, foot.y)) continue;
    const auto nearest = curbs.nearest(foot, kLateralReach);
    if (nearest.distance <= kLateralReach) lateral_cm.push_back(100 * nearest.distance);
  }
  score.lateral_median_cm = percentile(lateral_cm, 0.5);
  score.lateral_p95_cm = percentile(lateral_cm, 0.95);
  return score;
}

}  // namespace curbstone
