#include "tools/evaluate/truth/street_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>

#include "common/linear/decompositions.hpp"
#include "common/tiles/tile.hpp"
#include "services/semantic_map/tile/map_types.hpp"
#include "tools/evaluate/truth/clicked_curbs.hpp"
#include "tools/evaluate/truth/label_table.hpp"
#include "tools/evaluate/truth/labelled_scans.hpp"

namespace curbstone::evaluate::truth {

namespace {

constexpr double kReach = 30.0;     // m from the lidar; beyond it, points are too sparse for borders
constexpr double kApart = 0.30;     // m, maximum distance between the points of the two sides
constexpr double kFitRadius = 0.6;  // m
constexpr double kSmoothing = 0.75 / 2;
constexpr double kCompany = 0.8;  // m, maximum distance to the next points of the same curb
constexpr double kLowestStep = 0.04;

bool is_ground(Surface s) {
  return s == Surface::kRoad || s == Surface::kParking || s == Surface::kSidewalk || s == Surface::kTerrain;
}

/// Whether a curb rises from `low` to `high` where the two meet.
bool makes_curb(Surface low, Surface high) {
  return (high == Surface::kSidewalk && (low == Surface::kRoad || low == Surface::kParking)) ||
         (low == Surface::kRoad && high == Surface::kTerrain);
}

bool may_look_like_curb(Surface a, Surface b) {
  const auto are = [&](Surface x, Surface y) { return (a == x && b == y) || (a == y && b == x); };
  return are(Surface::kRoad, Surface::kParking) || are(Surface::kRoad, Surface::kVegetation) ||
         are(Surface::kSidewalk, Surface::kVegetation) || are(Surface::kSidewalk, Surface::kTerrain);
}

struct SurfacePoint {
  Eigen::Vector3d at;
  Surface surface;
};

/// A set of surfaces.
using Surfaces = unsigned;
constexpr Surfaces one(Surface s) {
  return 1U << static_cast<unsigned>(s);
}
template <class Accept>
Surfaces all_that(Accept accept) {
  Surfaces surfaces = 0;
  for (int s = 0; s <= static_cast<int>(Surface::kWall); ++s) {
    if (accept(static_cast<Surface>(s))) surfaces |= one(static_cast<Surface>(s));
  }
  return surfaces;
}

/// Neighbour search in the plane.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<SurfacePoint>& points) : points_(points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      Cell& cell = cells_[key(points[i].at.x(), points[i].at.y())];
      cell.points.push_back(i);
      cell.surfaces |= one(points[i].surface);
    }
  }
  /// visit(index, distance) for every point of these surfaces within `radius`.
  template <class Visit>
  void within(const Eigen::Vector3d& at, double radius, Surfaces surfaces, Visit visit) const {
    const TileKey low = key(at.x() - radius, at.y() - radius);
    const TileKey high = key(at.x() + radius, at.y() + radius);
    for (std::int32_t cx = low.x; cx <= high.x; ++cx) {
      for (std::int32_t cy = low.y; cy <= high.y; ++cy) {
        const auto it = cells_.find({cx, cy});
        if (it == cells_.end() || (it->second.surfaces & surfaces) == 0) continue;  // most ground is far from a border
        for (const std::size_t i : it->second.points) {
          const double distance = (points_[i].at - at).head<2>().norm();
          if (distance <= radius && (one(points_[i].surface) & surfaces) != 0) visit(i, distance);
        }
      }
    }
  }
  /// The nearest point of these surfaces within kApart.
  [[nodiscard]] std::optional<std::size_t> nearest(const Eigen::Vector3d& at, Surfaces surfaces) const {
    std::optional<std::size_t> best;
    double best_distance = std::numeric_limits<double>::max();
    within(at, kApart, surfaces, [&](std::size_t i, double distance) {
      if (distance >= best_distance) return;
      best = i;
      best_distance = distance;
    });
    return best;
  }

 private:
  struct Cell {
    std::vector<std::size_t> points;
    Surfaces surfaces = 0;
  };
  static TileKey key(double x, double y) {
    return {static_cast<std::int32_t>(std::floor(x / kApart)), static_cast<std::int32_t>(std::floor(y / kApart))};
  }
  const std::vector<SurfacePoint>& points_;
  std::unordered_map<TileKey, Cell, TileKeyHash> cells_;
};

/// Fits how much higher `high` lies than `low` around a place: z = a + step * [is high] + slope . (x, y).
std::optional<double> fit_step(const std::vector<SurfacePoint>& points, const Neighbours& neighbours,
                               const Eigen::Vector3d& at, Surface low, Surface high) {
  constexpr int kEnough = 6;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  int lows = 0;
  int highs = 0;
  neighbours.within(at, kFitRadius, one(low) | one(high), [&](std::size_t i, double) {
    const SurfacePoint& p = points[i];
    ++(p.surface == high ? highs : lows);
    const Eigen::Vector4d row(1, p.surface == high ? 1 : 0, p.at.x() - at.x(), p.at.y() - at.y());
    A += row * row.transpose();
    b += row * (p.at.z() - at.z());
  });
  if (lows < kEnough || highs < kEnough) return std::nullopt;
  A.diagonal().tail<2>().array() += 0.01;  // regularises the slope to zero where the points do not determine it
  return Ldlt<4>(A).solve(b)(1);
}

/// Points where two surfaces meet, one per cell of 0.1 m. Borders that are not curbs have height 0.
std::vector<TrueCurbPoint> find_borders(const std::vector<SurfacePoint>& points, const Neighbours& neighbours) {
  std::vector<TrueCurbPoint> borders;
  std::set<std::pair<int, int>> taken;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfacePoint& low = points[i];
    const Surfaces others =
        all_that([&](Surface s) { return makes_curb(low.surface, s) || may_look_like_curb(low.surface, s); });
    const auto j = neighbours.nearest(low.at, others);
    if (!j) continue;
    const SurfacePoint& high = points[*j];
    if (neighbours.nearest(high.at, one(low.surface)) != i) continue;
    const Eigen::Vector3d at = 0.5 * (low.at + high.at);
    const bool curb = makes_curb(low.surface, high.surface);
    const auto step = curb ? fit_step(points, neighbours, at, low.surface, high.surface) : 0.0;
    if (!step) continue;
    if (!taken.insert({static_cast<int>(std::floor(at.x() * 10)), static_cast<int>(std::floor(at.y() * 10))}).second)
      continue;
    borders.push_back({0, at.x(), at.y(), low.at.z(), *step, !curb});
  }
  return borders;
}

/// Median-smooths the height along a curb, and removes isolated curb points.
std::vector<TrueCurbPoint> smoothed(const std::vector<TrueCurbPoint>& borders) {
  constexpr int kEnough = 5;
  std::vector<TrueCurbPoint> result;
  for (const TrueCurbPoint& p : borders) {
    TrueCurbPoint smooth = p;
    smooth.line = static_cast<int>(result.size());
    if (!p.dropped) {
      std::vector<double> steps;
      int company = 0;
      for (const TrueCurbPoint& q : borders) {
        if (q.dropped) continue;
        const double distance = std::hypot(q.x - p.x, q.y - p.y);
        if (distance <= kSmoothing) steps.push_back(q.height);
        company += distance <= kCompany ? 1 : 0;
      }
      if (company < kEnough) continue;
      const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
      std::nth_element(steps.begin(), middle, steps.end());
      smooth.height = *middle;
      smooth.dropped = smooth.height < kLowestStep;
    }
    result.push_back(smooth);
  }
  return result;
}

/// Replaces the points, which lie where scan lines cross a curb, by lines: two points are joined unless a third lies
/// between them (their relative neighbourhood graph), with one point every 0.1 m.
void link(std::vector<TrueCurbPoint>& borders) {
  constexpr double kSpacing = 0.1;  // m
  const std::vector<TrueCurbPoint> points = borders;
  const auto apart = [&](std::size_t i, std::size_t j) {
    return std::hypot(points[i].x - points[j].x, points[i].y - points[j].y);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double distance = apart(i, j);
      if (distance > kCompany || distance <= 1.5 * kSpacing || points[i].dropped != points[j].dropped) continue;
      const auto is_between = [&](std::size_t k) { return apart(i, k) < distance && apart(j, k) < distance; };
      bool direct = true;
      for (std::size_t k = 0; k < points.size() && direct; ++k) direct = !is_between(k);
      const int pieces = static_cast<int>(std::ceil(distance / kSpacing));
      for (int piece = 1; direct && piece < pieces; ++piece) {
        const double f = static_cast<double>(piece) / pieces;
        const auto mix = [f](double a, double b) { return a + f * (b - a); };
        borders.push_back({static_cast<int>(borders.size()), mix(points[i].x, points[j].x),
                           mix(points[i].y, points[j].y), mix(points[i].z, points[j].z),
                           mix(points[i].height, points[j].height), points[i].dropped});
      }
    }
  }
}

TrueClasses paint(const std::vector<SurfacePoint>& points, const std::vector<TrueCurbPoint>& curbs) {
  TrueClasses classes;
  Eigen::Vector2d low = points.front().at.head<2>();
  Eigen::Vector2d high = low;
  for (const SurfacePoint& p : points) {
    low = low.cwiseMin(p.at.head<2>());
    high = high.cwiseMax(p.at.head<2>());
  }
  classes.origin_x = low.x();
  classes.origin_y = low.y();
  classes.width = static_cast<int>((high.x() - low.x()) / classes.resolution) + 1;
  classes.height = static_cast<int>((high.y() - low.y()) / classes.resolution) + 1;
  classes.pixels.assign(static_cast<std::size_t>(classes.width) * static_cast<std::size_t>(classes.height), 0);
  const auto set = [&](double x, double y, semantic_map::tile::CellClass cell_class) {
    classes.set(x, y, static_cast<std::uint8_t>(cell_class));
  };
  for (const SurfacePoint& p : points) {
    if (p.surface == Surface::kTerrain) classes.set(p.at.x(), p.at.y(), StreetLabels::kLabelledOnly);
  }
  for (const SurfacePoint& p : points) {
    if (is_ground(p.surface) && p.surface != Surface::kTerrain)
      set(p.at.x(), p.at.y(), semantic_map::tile::CellClass::kRoad);
  }
  for (const SurfacePoint& p : points) {
    if (p.surface == Surface::kWall) set(p.at.x(), p.at.y(), semantic_map::tile::CellClass::kWall);
  }
  for (const TrueCurbPoint& p : curbs) {
    if (p.dropped)
      classes.set(p.x, p.y, StreetLabels::kLabelledOnly);
    else
      set(p.x, p.y, semantic_map::tile::CellClass::kCurb);
  }
  return classes;
}

}  // namespace

Border StreetLabels::border_at(double x, double y, double up_x, double up_y) const {
  if (surfaces.empty()) return classes.known_around(x, y) ? Border::kNone : Border::kNotKnown;
  constexpr std::array kOff = {0.12, 0.24, 0.36, 0.48};  // m
  const auto side = [&](double sign) {
    std::array<int, kNumSurfaces> votes{};
    for (const double off : kOff) {
      const auto surface = static_cast<std::size_t>(surfaces.at(x + sign * off * up_x, y + sign * off * up_y));
      ++votes[surface % kNumSurfaces];
    }
    votes[0] = 0;
    const auto most = std::max_element(votes.begin(), votes.end());
    return *most > 0 ? static_cast<Surface>(most - votes.begin()) : Surface::kNone;
  };
  const Surface low = side(-1);
  const Surface high = side(1);
  if (low == Surface::kNone || high == Surface::kNone || !classes.known_around(x, y)) return Border::kNotKnown;
  return makes_curb(low, high) || makes_curb(high, low) || may_look_like_curb(low, high) ? Border::kSomewhere
                                                                                         : Border::kNone;
}

StreetLabels read_street_labels(const std::string& folder, const Pose& T_world_first) {
  if (has_clicked_curbs(folder)) return read_clicked_curbs(folder, T_world_first);
  const LabelTable table(folder);
  std::vector<SurfacePoint> points;
  for (const LabelledPoint& p : read_labelled_scans(folder, T_world_first, kReach)) {
    if (const Surface surface = table.surface_of(p.label); surface != Surface::kNone) points.push_back({p.at, surface});
  }
  StreetLabels labels;
  if (points.empty()) return labels;
  labels.curbs = smoothed(find_borders(points, Neighbours(points)));
  link(labels.curbs);
  labels.classes = paint(points, labels.curbs);
  labels.surfaces = labels.classes;
  std::fill(labels.surfaces.pixels.begin(), labels.surfaces.pixels.end(), std::uint8_t{0});
  for (const SurfacePoint& p : points) labels.surfaces.set(p.at.x(), p.at.y(), static_cast<std::uint8_t>(p.surface));
  return labels;
}

}  // namespace curbstone::evaluate::truth
