#include "tools/evaluate/curb_score.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics/quantile.hpp"
#include "tools/evaluate/place_grid.hpp"

namespace curbstone::evaluate {

namespace {

constexpr double kBucket = 1.0;        // m
constexpr double kJoin = 0.5;          // m
constexpr double kLateralReach = 0.5;  // m; a larger distance is a false detection, not a lateral error

Place nearest_on_segment(Place p, Place a, Place b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return {a.x + t * dx, a.y + t * dy};
}

}  // namespace

TrueCurbs::TrueCurbs(const std::vector<truth::TrueCurbPoint>& points) {
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
  const double span = reach + kJoin;  // a segment is in the bucket of its first end
  const int first_column = std::max(0, static_cast<int>(std::floor((place.x - span - min_x_) / kBucket)));
  const int last_column = std::min(columns_ - 1, static_cast<int>(std::floor((place.x + span - min_x_) / kBucket)));
  const int first_row = std::max(0, static_cast<int>(std::floor((place.y - span - min_y_) / kBucket)));
  const int last_row = std::min(rows_ - 1, static_cast<int>(std::floor((place.y + span - min_y_) / kBucket)));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      for (const Segment& segment : buckets_[static_cast<std::size_t>(row * columns_ + column)]) {
        const Place on = nearest_on_segment(place, segment.a, segment.b);
        const double distance = std::hypot(place.x - on.x, place.y - on.y);
        if (distance > reach) continue;
        if (segment.dropped) {
          nearest.dropped = std::min(nearest.dropped, distance);
        } else if (distance < nearest.distance) {
          nearest.distance = distance;
          nearest.place = on;
        }
      }
    }
  }
  return nearest;
}

namespace {

using NearPath = PlaceGrid<Place>;

void score_precision(const CurbMap& map, const TrueCurbs& curbs, const NearPath& near_path, CurbScore& score) {
  std::array<int, kTolerances.size()> right{};
  for (const CurbCell& cell : map.cells) {
    if (!near_path.any_near(cell.at.x, cell.at.y)) continue;
    const auto nearest = curbs.nearest(cell.at, kLateralReach);
    if (nearest.dropped <= kLateralReach && nearest.dropped < nearest.distance) {
      ++score.on_dropped;
      continue;
    }
    if (!cell.judged && nearest.distance > kTolerances.back()) {
      ++score.beyond_truth;
      continue;
    }
    ++score.detections;
    for (std::size_t i = 0; i < kTolerances.size(); ++i) right[i] += nearest.distance <= kTolerances[i] ? 1 : 0;
    if (nearest.distance > kTolerances.back()) score.wrong.push_back(cell.at);
  }
  for (std::size_t i = 0; i < kTolerances.size(); ++i) {
    score.at[i].precision = score.detections > 0 ? static_cast<double>(right[i]) / score.detections : 0;
  }
}

void score_recall(const CurbMap& map, const std::vector<truth::TrueCurbPoint>& truth, const NearPath& near_path,
                  CurbScore& score) {
  const PlaceGrid<Place> seen(map.seen, kTolerances.back());
  std::vector<Place> centres;
  for (const CurbCell& cell : map.cells) centres.push_back(cell.at);
  std::vector<PlaceGrid<Place>> cells;
  for (const double tolerance : kTolerances) cells.emplace_back(centres, tolerance);
  std::array<int, kTolerances.size()> found{};
  int seen_points = 0;
  for (const truth::TrueCurbPoint& point : truth) {
    if (point.dropped || !near_path.any_near(point.x, point.y)) continue;
    ++score.true_points;
    seen_points += seen.any_near(point.x, point.y) ? 1 : 0;
    for (std::size_t i = 0; i < kTolerances.size(); ++i) found[i] += cells[i].any_near(point.x, point.y) ? 1 : 0;
    const auto step = std::lower_bound(kStepBounds.begin(), kStepBounds.end(), point.height) - kStepBounds.begin();
    CurbScore::Share& share = score.by_step[static_cast<std::size_t>(step)];
    ++share.points;
    if (cells.back().any_near(point.x, point.y))
      ++share.found;
    else
      score.missed.push_back({point.x, point.y});
  }
  for (std::size_t i = 0; i < kTolerances.size(); ++i) {
    score.at[i].recall = score.true_points > 0 ? static_cast<double>(found[i]) / score.true_points : 0;
  }
  score.recall_of_seen = seen_points > 0 ? static_cast<double>(found.back()) / seen_points : 0;
}

void score_lowered(const CurbMap& map, const std::vector<truth::TrueCurbPoint>& truth, const TrueCurbs& curbs,
                   const NearPath& near_path, CurbScore& score) {
  const PlaceGrid<Place> lowered(map.lowered, kTolerances.back());
  for (const truth::TrueCurbPoint& point : truth) {
    const bool is_lowered = point.dropped && point.height > 0;  // a border of height 0 is not a curb
    if (!is_lowered || !near_path.any_near(point.x, point.y)) continue;
    ++score.lowered_points;
    score.lowered_found += lowered.any_near(point.x, point.y) ? 1 : 0;
  }
  for (const Place& place : map.lowered) {
    if (!near_path.any_near(place.x, place.y)) continue;
    ++score.lowered_feet;
    score.lowered_wrong += curbs.nearest(place, kTolerances.back()).dropped > kTolerances.back() ? 1 : 0;
  }
}

/// Call it after score_recall(), which sets the missed points.
void score_inferred(const CurbMap& map, const TrueCurbs& curbs, const NearPath& near_path, CurbScore& score) {
  std::vector<Place> places;
  double right = 0;
  for (const CurbMap::Inferred& inferred : map.inferred) {
    if (!near_path.any_near(inferred.at.x, inferred.at.y)) continue;
    places.push_back(inferred.at);
    const bool is_right = curbs.nearest(inferred.at, kTolerances.back()).distance <= kTolerances.back();
    if (!inferred.judged && !is_right) continue;
    score.inferred_m += inferred.length;
    right += is_right ? inferred.length : 0;
  }
  score.inferred_right = score.inferred_m > 0 ? right / score.inferred_m : 0;
  const PlaceGrid<Place> near_inferred(places, kTolerances.back());
  for (const Place& missed : score.missed) score.inferred_found += near_inferred.any_near(missed.x, missed.y) ? 1 : 0;
}

void score_lateral(const CurbMap& map, const TrueCurbs& curbs, const NearPath& near_path, CurbScore& score) {
  std::vector<double> sizes;
  std::vector<double> offsets;  // towards the higher side
  for (const CurbFoot& foot : map.feet) {
    if (!near_path.any_near(foot.at.x, foot.at.y)) continue;
    const auto nearest = curbs.nearest(foot.at, kLateralReach);
    if (nearest.distance > kLateralReach) continue;
    sizes.push_back(100 * nearest.distance);
    const double along = (foot.at.x - nearest.place.x) * foot.up.x + (foot.at.y - nearest.place.y) * foot.up.y;
    offsets.push_back(100 * along);
  }
  if (sizes.empty()) return;
  score.lateral_median_cm = quantile_in_place(sizes, 0.5);
  score.lateral_p95_cm = quantile_in_place(sizes, 0.95);
  score.lateral_bias_cm = quantile_in_place(offsets, 0.5);
  for (double& offset : offsets) offset = std::abs(offset - score.lateral_bias_cm);
  score.lateral_spread_cm = 1.4826 * quantile_in_place(offsets, 0.5);
}

}  // namespace

CurbScore score_curbs(const CurbMap& map, const std::vector<truth::TrueCurbPoint>& truth,
                      const std::vector<Place>& path, double radius) {
  CurbScore score;
  const TrueCurbs curbs(truth);
  const NearPath near_path(path, radius);
  score_precision(map, curbs, near_path, score);
  score_recall(map, truth, near_path, score);
  score_lowered(map, truth, curbs, near_path, score);
  score_inferred(map, curbs, near_path, score);
  score_lateral(map, curbs, near_path, score);
  return score;
}

}  // namespace curbstone::evaluate
