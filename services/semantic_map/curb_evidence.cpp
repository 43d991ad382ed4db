#include "services/semantic_map/curb_evidence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "services/semantic_map/height_step.hpp"
#include "services/semantic_map/vectorised.hpp"

namespace curbstone {

namespace {

constexpr double kMargin = 1.20;  // m around the tile: ten cells, as far as a window reaches
constexpr int kMarginCells = 10;
constexpr int kSide = kCellsPerTile + 2 * kMarginCells;
constexpr double kBelowGround = 0.30;       // m: what is lower is a stray
constexpr std::size_t kEnoughPoints = 100;  // in the short window: looking farther would not make it clearer
constexpr double kMinCoarseTilt = 0.008;
constexpr int kMinTilted = 1;         // points in a cell
constexpr double kSparse = 2.0;       // times the length of the window, where points are few
constexpr float kThinMass = 10;       // of the vote; even ground at sigma 0.3 m, thinned to 0.1 m, has 27
constexpr double kThin = 4.0;         // and where there are only single scan lines
constexpr double kMinNormalZ = 0.35;  // steeper is no curb at this scale, it is a wall
constexpr int kMaxFacePoints = 3;     // on the step and above it: more are a wall's
constexpr double kSearch = 0.24;      // m: how far the found step may be from the tilted points

struct NearGround {
  float x, y, z;         // m, z above the ground
  float tilt_x, tilt_y;  // slope of the surface against the ground's, by the normal
  bool tilted;
  bool is_ground;  // by its normal: what may carry a side of a step
  bool is_line;    // the vote saw little more than a scan line
};

/// Points near the ground, sorted into cells of 0.12 m (counting sort, so that a row of cells is one range).
class NearGroundPoints {
 public:
  NearGroundPoints(const Around<VotedTile>& tiles, const GroundSurface& ground, const CurbParameters& parameters) {
    std::vector<NearGround> points;
    std::vector<int> cell_of;
    tiles.for_each([&](const VotedTile& tile, double dx, double dy) {
      for (const VotedPoint& p : tile.points) {
        const double x = double{p.x} + dx;
        const double y = double{p.y} + dy;
        if (x < -kMargin || y < -kMargin || x >= kTileSize + kMargin || y >= kTileSize + kMargin) continue;
        const auto g = ground.below(x, y);
        if (!g) continue;
        const double above = double{p.z} - g->height;
        if (above < -kBelowGround || above > parameters.max_step) continue;
        points.push_back(describe(p, *g, x, y, above, parameters));
        cell_of.push_back(cell(y) * kSide + cell(x));
      }
    });
    start_.assign(static_cast<std::size_t>(kSide * kSide) + 1, 0);
    for (const int c : cell_of) ++start_[static_cast<std::size_t>(c) + 1];
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    points_.resize(points.size());
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell_of[i])]++)] = points[i];
    }
    for (const NearGround& p : points_) {
      x_.push_back(double{p.x});
      y_.push_back(double{p.y});
      z_.push_back(double{p.z});
      unfit_.push_back(p.is_ground ? 0 : StepWindow::kUnfit);
    }
  }

  /// visit(point) for all points in cells (column, row) of the tile, ranges inclusive.
  template <class Visit>
  void for_cells(int column0, int column1, int row0, int row1, Visit visit) const {
    column0 = std::clamp(column0 + kMarginCells, 0, kSide - 1);
    column1 = std::clamp(column1 + kMarginCells, 0, kSide - 1);
    row0 = std::clamp(row0 + kMarginCells, 0, kSide - 1);
    row1 = std::clamp(row1 + kMarginCells, 0, kSide - 1);
    for (int row = row0; row <= row1; ++row) {
      const auto begin = start_[static_cast<std::size_t>(row * kSide + column0)];
      const auto end = start_[static_cast<std::size_t>(row * kSide + column1) + 1];
      for (int i = begin; i < end; ++i) visit(points_[static_cast<std::size_t>(i)]);
    }
  }
  /// First and behind the last of the points in a row's cells, columns inclusive, of the tile; empty if there are none.
  [[nodiscard]] std::pair<std::size_t, std::size_t> range(int column0, int column1, int row) const {
    if (column1 < column0) return {0, 0};
    column0 = std::clamp(column0 + kMarginCells, 0, kSide - 1);
    column1 = std::clamp(column1 + kMarginCells, 0, kSide - 1);
    row = std::clamp(row + kMarginCells, 0, kSide - 1);
    return {static_cast<std::size_t>(start_[static_cast<std::size_t>(row * kSide + column0)]),
            static_cast<std::size_t>(start_[static_cast<std::size_t>(row * kSide + column1) + 1])};
  }
  // The same points by columns, as a StepWindow has them.
  [[nodiscard]] const double* x() const { return x_.data(); }
  [[nodiscard]] const double* y() const { return y_.data(); }
  [[nodiscard]] const double* z() const { return z_.data(); }
  [[nodiscard]] const double* unfit() const { return unfit_.data(); }

 private:
  static int cell(double x) { return std::clamp(static_cast<int>((x + kMargin) / kCellSize), 0, kSide - 1); }

  static NearGround describe(const VotedPoint& p, const GroundBelow& g, double x, double y, double above,
                             const CurbParameters& parameters) {
    NearGround n{static_cast<float>(x),
                 static_cast<float>(y),
                 static_cast<float>(above),
                 0,
                 0,
                 false,
                 may_be_ground(p, parameters),
                 is_scan_line(p) || p.mass < kThinMass};
    const auto nz = static_cast<double>(p.normal.z());
    if (p.mass <= 0 || nz < kMinNormalZ) return n;
    const Eigen::Vector2d tilt = Eigen::Vector2d(-double{p.normal.x()}, -double{p.normal.y()}) / nz - g.normal_slope;
    n.tilt_x = static_cast<float>(tilt.x());
    n.tilt_y = static_cast<float>(tilt.y());
    n.tilted = tilt.norm() > std::max(parameters.min_tilt, parameters.tilt_sigmas * g.normal_noise);
    return n;
  }

  std::vector<NearGround> points_;
  std::vector<double> x_, y_, z_, unfit_;
  std::vector<int> start_;
};

/// From .. to, m; empty where to < from.
struct Interval {
  double from, to;
};

/// The places between two parallel lines: |a x + b y| <= most.
class Band {
 public:
  Band(double a, double b, double most) : b_(b), most_(most), inverse_a_(std::abs(a) < 1e-2 ? 0 : 1 / a) {}
  /// Those of x for which there is such a place with some y.
  [[nodiscard]] Interval cut(const Interval& x, const Interval& y) const {
    if (inverse_a_ == 0) return x;
    const double p = (-most_ - std::max(b_ * y.from, b_ * y.to)) * inverse_a_;
    const double q = (most_ - std::min(b_ * y.from, b_ * y.to)) * inverse_a_;
    return {std::max(x.from, std::min(p, q)), std::min(x.to, std::max(p, q))};
  }

 private:
  double b_, most_, inverse_a_;
};
constexpr double kRounding = 1e-4;  // m: how much too small an interval may be

/// A cell whose normals tilt: where, and which way up.
struct TiltedCell {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  int count = 0;
  bool is_thin = false;  // scan lines only: which way is up is not the vote's word
};

TiltedCell gather_tilt(const NearGroundPoints& points, const GroundSurface& ground, int column, int row,
                       const CurbParameters& parameters) {
  TiltedCell cell;
  points.for_cells(column, column, row, row, [&](const NearGround& p) {
    if (parameters.use_tilt && !p.tilted) return;
    cell.at += Eigen::Vector2d(double{p.x}, double{p.y});
    cell.tilt += Eigen::Vector2d(double{p.tilt_x}, double{p.tilt_y});
    ++cell.count;
  });
  if (cell.count > 0) {
    cell.at /= cell.count;
    cell.tilt /= cell.count;
    return cell;
  }
  points.for_cells(column, column, row, row, [&](const NearGround& p) {
    if (!p.is_line) return;
    cell.at += Eigen::Vector2d(double{p.x}, double{p.y});
    ++cell.count;
  });
  if (cell.count == 0) return cell;
  cell.at /= cell.count;
  cell.is_thin = true;
  if (const auto here = ground.at(cell.at.x(), cell.at.y())) cell.tilt = here->coarse_tilt;
  if (cell.tilt.norm() < kMinCoarseTilt) cell.count = 0;
  return cell;
}

/// What is looked at for a step: a rectangle about a cell, `up` across it.
struct StepRectangle {
  Eigen::Vector2d at;
  Eigen::Vector2d up;
  double half_width;   ///< m along `up`
  double half_length;  ///< m
};

CURBSTONE_VECTORISED
void turn_points(const double* x, const double* y, std::size_t n, const StepRectangle& r, double* u, double* t) {
  const double at_x = r.at.x();
  const double at_y = r.at.y();
  const double up_x = r.up.x();
  const double up_y = r.up.y();
  for (std::size_t i = 0; i < n; ++i) {
    const double dx = x[i] - at_x;
    const double dy = y[i] - at_y;
    u[i] = dx * up_x + dy * up_y;
    t[i] = dx * -up_y + dy * up_x;
  }
}

/// The points in the rectangle and, unless `exactly`, those beyond its two ends across. Others around it may be among
/// them, too far along to count.
void fill_window(const NearGroundPoints& points, const StepRectangle& r, bool exactly, StepWindow& window) {
  const Eigen::Vector2d along(-r.up.y(), r.up.x());
  const double extent_x = std::abs(r.up.x()) * r.half_width + std::abs(along.x()) * r.half_length;
  const double extent_y = std::abs(r.up.y()) * r.half_width + std::abs(along.y()) * r.half_length;
  constexpr int kFar = 1000;  // cells, to round down by truncation
  const auto cell_at = [](double x) { return static_cast<int>(x / kCellSize + kFar) - kFar; };
  const int column0 = cell_at(r.at.x() - extent_x);
  const int column1 = cell_at(r.at.x() + extent_x);
  const int row1 = std::min(cell_at(r.at.y() + extent_y), kCellsPerTile + kMarginCells - 1);
  const Interval box{column0 * kCellSize - r.at.x(), (column1 + 1) * kCellSize - r.at.x()};
  const Band lengthwise(along.x(), along.y(), r.half_length);
  const Band crosswise(r.up.x(), r.up.y(), r.half_width);
  std::size_t n = 0;
  for (int row = std::max(cell_at(r.at.y() - extent_y), -kMarginCells); row <= row1; ++row) {
    // Of this row only as far as the rectangle may reach in it.
    const Interval y{row * kCellSize - r.at.y(), (row + 1) * kCellSize - r.at.y()};
    Interval x = lengthwise.cut(box, y);
    if (exactly) x = crosswise.cut(x, y);
    const auto [begin, end] = points.range(std::max(column0, cell_at(r.at.x() + x.from - kRounding)),
                                           std::min(column1, cell_at(r.at.x() + x.to + kRounding)), row);
    const std::size_t num = end - begin;
    if (num == 0) continue;
    if (window.u.size() < n + num) window.resize(2 * (n + num));
    turn_points(points.x() + begin, points.y() + begin, num, r, window.u.data() + n, window.t.data() + n);
    std::copy_n(points.z() + begin, num, window.z.data() + n);
    std::copy_n(points.unfit() + begin, num, window.unfit.data() + n);
    n += num;
  }
  window.resize(n);
  window.half_length = r.half_length;
}

std::size_t count_points(const StepWindow& window) {
  std::size_t n = 0;
  for (const double t : window.t) n += std::abs(t) <= window.half_length ? 1U : 0U;
  return n;
}

/// A step, the direction in which it is one, and how far along it the evidence lies.
struct FoundStep {
  HeightStep step;
  double foot = 0;
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();
  double half_length = 0;  // 0: there is none
  [[nodiscard]] bool exists() const { return half_length > 0; }
};

/// Whether a step is one: against its own uncertainty, against the noise of its surroundings...
bool is_certain(const HeightStep& step, double noise, const CurbParameters& parameters) {
  const double sigma = step.sigma * std::max(1.0, noise / step.roughness);
  return step.height <= parameters.max_step && step.height >= parameters.min_weak_step &&
         step.height >= parameters.step_sigmas * sigma && step.height >= parameters.layer_sigmas * noise;
}

/// ... and on both sides.
bool parts_its_sides(const StepSides& sides, const HeightStep& step, const CurbParameters& parameters) {
  return sides.face_above <= kMaxFacePoints && sides.clear >= parameters.clear_share * step.height;
}

/// Looks for steps at a cell, and keeps the most certain one: that also chooses between a long window, which sees more
/// of a straight curb, and a short one, which a bend fits into.
class StepSearch {
 public:
  StepSearch(const NearGroundPoints& points, const TiltedCell& cell, double noise, const CurbParameters& parameters,
             StepWindow& window)
      : points_(points), cell_(cell), noise_(noise), parameters_(parameters), window_(window) {}

  /// Returns whether many points are around.
  bool look_close(const Eigen::Vector2d& up, double half_length) {
    look(up, half_length, false);
    return count_points(window_) > kEnoughPoints;
  }
  void look(const Eigen::Vector2d& up, double half_length, bool exactly = true) {
    fill_window(points_, {cell_.at, up, parameters_.half_window + kSearch, half_length}, exactly, window_);
    const auto step = find_height_step(window_, noise_, parameters_);
    // What is quickly told comes first.
    if (!step || !is_certain(*step, noise_, parameters_)) return;
    if (best_.exists() && step->height * best_.step.sigma <= best_.step.height * step->sigma) return;
    const StepSides sides = look_at_sides(window_, *step, parameters_);
    if (parts_its_sides(sides, *step, parameters_)) best_ = {*step, sides.foot, up, half_length};
  }
  [[nodiscard]] const FoundStep& best() const { return best_; }

 private:
  const NearGroundPoints& points_;
  const TiltedCell& cell_;
  double noise_;
  const CurbParameters& parameters_;
  StepWindow& window_;
  FoundStep best_;
};

/// The step at a cell. Where points are dense, the vote's word on which way is up is good, and a short window enough.
/// Where they are few it is looked for farther along, about the directions of the vote and of the ground at large.
FoundStep find_step(const NearGroundPoints& points, const TiltedCell& cell, const Eigen::Vector2d& coarse_tilt,
                    double noise, const CurbParameters& parameters, StepWindow& window) {
  StepSearch search(points, cell, noise, parameters, window);
  std::vector<Eigen::Vector2d> directions;
  const double length = parameters.half_length;
  if (!cell.is_thin) {
    directions.push_back(cell.tilt.normalized());
    if (search.look_close(directions.back(), length)) return search.best();
    search.look(directions.back(), kSparse * length);
  }
  if (coarse_tilt.norm() > kMinCoarseTilt) {
    directions.push_back(coarse_tilt.normalized());
    search.look(directions.back(), kSparse * length);
  }
  for (const Eigen::Vector2d& direction : directions) {
    for (const double turn : {0.0, -0.12, 0.12, -0.24, 0.24})
      search.look(Eigen::Rotation2Dd(turn) * direction, kThin * length);
  }
  return search.best();
}

std::optional<CurbCandidate> test_cell(const NearGroundPoints& points, const TiltedCell& cell,
                                       const GroundSurface& ground, const CurbParameters& parameters,
                                       StepWindow& window) {
  const double tilt = cell.tilt.norm();
  if (!(tilt > 1e-6)) return std::nullopt;
  CurbCandidate candidate;
  candidate.up = cell.tilt / tilt;
  if (!parameters.use_step) {
    candidate.foot = cell.at;
    candidate.score = tilt;
    candidate.height = 0.5 * tilt;  // what a step of that height tilts the normals by at sigma 0.3
  } else {
    const auto here = ground.at(cell.at.x(), cell.at.y());
    if (!here) return std::nullopt;
    const FoundStep found = find_step(points, cell, here->coarse_tilt, here->layer_noise, parameters, window);
    if (!found.exists()) return std::nullopt;
    const HeightStep& step = found.step;
    candidate.up = found.up;
    candidate.reach = found.half_length;
    candidate.weak = step.height < parameters.min_step;
    candidate.foot = cell.at + found.foot * candidate.up;
    candidate.height = step.height;
    candidate.score = step.height / step.sigma;
    candidate.z = step.low_z;
  }
  const auto height = ground.height(candidate.foot.x(), candidate.foot.y());
  if (!height) return std::nullopt;
  candidate.z += *height;
  return candidate;
}

}  // namespace

std::vector<CurbCandidate> find_curb_evidence(const Around<VotedTile>& tiles, const GroundSurface& ground,
                                              const CurbParameters& parameters) {
  std::vector<CurbCandidate> candidates;
  const NearGroundPoints points(tiles, ground, parameters);
  StepWindow window;  // one for all, for the sake of its memory
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const TiltedCell cell = gather_tilt(points, ground, column, row, parameters);
      if (cell.count < kMinTilted) continue;
      if (const auto candidate = test_cell(points, cell, ground, parameters, window)) candidates.push_back(*candidate);
    }
  }
  return candidates;
}

}  // namespace curbstone
