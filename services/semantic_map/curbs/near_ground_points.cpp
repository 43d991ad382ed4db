#include "services/semantic_map/curbs/near_ground_points.hpp"

#include <cmath>

#include "services/semantic_map/curbs/height_step.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kWindowMargin = NearGroundPoints::kMarginCells * kCellSize;  // m: as far as a window reaches
constexpr double kBelowGround = 0.30;                                         // m: what is lower is a stray
constexpr float kThinMass = 10;       // of the vote; even ground at sigma 0.3 m, thinned to 0.1 m, has 27
constexpr double kMinNormalZ = 0.35;  // steeper is no curb at this scale, it is a wall

NearGround describe(const tile::VotedPoint& p, const ground::GroundBelow& g, double x, double y, double above,
                    const tile::CurbParameters& parameters) {
  NearGround n{.x = static_cast<float>(x), .y = static_cast<float>(y), .z = static_cast<float>(above)};
  n.is_ground = ground::may_be_ground(p, parameters);
  n.is_line = ground::is_scan_line(p) || p.mass < kThinMass;
  const auto nz = static_cast<double>(p.normal.z());
  if (p.mass <= 0 || nz < kMinNormalZ) return n;
  const Eigen::Vector2d tilt = Eigen::Vector2d(-double{p.normal.x()}, -double{p.normal.y()}) / nz - g.normal_slope;
  n.tilt_x = static_cast<float>(tilt.x());
  n.tilt_y = static_cast<float>(tilt.y());
  n.tilted = tilt.norm() > std::max(parameters.min_tilt, parameters.tilt_sigmas * g.normal_noise);
  return n;
}

}  // namespace

NearGroundPoints::NearGroundPoints(const tile::Around<tile::VotedTile>& tiles, const ground::GroundSurface& ground,
                                   const tile::CurbParameters& parameters) {
  const auto cell = [](double x) {
    return std::clamp(static_cast<int>((x + kWindowMargin) / kCellSize), 0, kSide - 1);
  };
  thread_local std::vector<NearGround> points;  // for the sake of their memory
  thread_local std::vector<int> cell_of;
  points.clear();
  cell_of.clear();
  tiles.for_each([&](const tile::VotedTile& tile, double dx, double dy) {
    for (const tile::VotedPoint& p : tile.points) {
      const double x = double{p.x} + dx;
      const double y = double{p.y} + dy;
      if (x < -kWindowMargin || y < -kWindowMargin || x >= kTileSize + kWindowMargin || y >= kTileSize + kWindowMargin)
        continue;
      const auto g = ground.below(x, y);
      if (!g) continue;
      const double above = double{p.z} - g->height;
      if (above < -kBelowGround || above > parameters.max_step) continue;
      points.push_back(describe(p, *g, x, y, above, parameters));
      cell_of.push_back(cell(y) * kSide + cell(x));
    }
  });
  // Counting sort.
  start_.assign(static_cast<std::size_t>(kSide * kSide) + 1, 0);
  for (const int c : cell_of) ++start_[static_cast<std::size_t>(c) + 1];
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  points_.resize(points.size());
  for (std::vector<double>* column : {&x_, &y_, &z_, &unfit_}) column->resize(points.size() + kPadding);
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const NearGround& p = points[i];
    const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(cell_of[i])]++);
    points_[at] = p;
    x_[at] = double{p.x};
    y_[at] = double{p.y};
    z_[at] = double{p.z};
    unfit_[at] = p.is_ground ? 0 : StepWindow::kUnfit;
  }
}

}  // namespace curbstone::semantic_map::curbs
