#include "services/semantic_map/curb_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "services/semantic_map/height_step.hpp"

namespace curbstone {

namespace {

constexpr double kMargin = 0.84;  // m around the tile: seven cells, as far as a window reaches
constexpr int kMarginCells = 7;
constexpr int kSide = kCellsPerTile + 2 * kMarginCells;
constexpr double kBelowGround = 0.30;  // m: what is lower is a stray
constexpr int kMinTilted = 1;          // points in a cell
constexpr double kSparse = 2.0;        // times the length of the window, where points are few
constexpr double kMinNormalZ = 0.35;   // steeper is no curb at this scale, it is a wall
constexpr int kMaxFacePoints = 3;      // on the step and above it: more are a wall's
constexpr double kSearch = 0.24;       // m: how far the found step may be from the tilted points

struct NearGround {
  float x, y, z;         // m, z above the ground
  float tilt_x, tilt_y;  // slope of the surface against the ground's, by the normal
  bool tilted;
  bool is_ground;  // by its normal: what may carry a side of a step
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
        const auto g = ground.at(x, y);
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

 private:
  static int cell(double x) { return std::clamp(static_cast<int>((x + kMargin) / kCellSize), 0, kSide - 1); }

  static NearGround describe(const VotedPoint& p, const GroundAt& g, double x, double y, double above,
                             const CurbParameters& parameters) {
    NearGround n{static_cast<float>(x),       static_cast<float>(y), static_cast<float>(above), 0, 0, false,
                 may_be_ground(p, parameters)};
    const auto nz = static_cast<double>(p.normal.z());
    if (p.mass <= 0 || nz < kMinNormalZ) return n;
    const Eigen::Vector2d tilt = Eigen::Vector2d(-double{p.normal.x()}, -double{p.normal.y()}) / nz - g.normal_slope;
    n.tilt_x = static_cast<float>(tilt.x());
    n.tilt_y = static_cast<float>(tilt.y());
    n.tilted = tilt.norm() > std::max(parameters.min_tilt, parameters.tilt_sigmas * g.normal_noise);
    return n;
  }

  std::vector<NearGround> points_;
  std::vector<int> start_;
};

/// A cell whose normals tilt: where, and which way up.
struct TiltedCell {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  int count = 0;
};

TiltedCell gather_tilt(const NearGroundPoints& points, int column, int row, const CurbParameters& parameters) {
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
  }
  return cell;
}

std::vector<StepPointUTZ> window_around(const NearGroundPoints& points, const TiltedCell& cell,
                                        const Eigen::Vector2d& up, double half_length,
                                        const CurbParameters& parameters) {
  std::vector<StepPointUTZ> window;
  const double reach = parameters.half_window + kSearch;
  const Eigen::Vector2d along(-up.y(), up.x());
  const double extent_x = std::abs(up.x()) * reach + std::abs(along.x()) * half_length;
  const double extent_y = std::abs(up.y()) * reach + std::abs(along.y()) * half_length;
  const auto cell_at = [](double x) { return static_cast<int>(std::floor(x / kCellSize)); };
  points.for_cells(cell_at(cell.at.x() - extent_x), cell_at(cell.at.x() + extent_x), cell_at(cell.at.y() - extent_y),
                   cell_at(cell.at.y() + extent_y), [&](const NearGround& p) {
                     const Eigen::Vector2d d = Eigen::Vector2d(double{p.x}, double{p.y}) - cell.at;
                     const double t = d.dot(along);
                     if (std::abs(t) <= half_length) window.push_back({d.dot(up), t, double{p.z}, p.is_ground});
                   });
  return window;
}

std::optional<CurbCandidate> test_cell(const NearGroundPoints& points, const TiltedCell& cell,
                                       const GroundSurface& ground, const CurbParameters& parameters) {
  const double tilt = cell.tilt.norm();
  if (!(tilt > 1e-6)) return std::nullopt;
  CurbCandidate candidate;
  candidate.up = cell.tilt / tilt;
  if (!parameters.use_step) {
    candidate.foot = cell.at;
    candidate.score = tilt;
    candidate.height = 0.5 * tilt;  // what a step of that height tilts the normals by at sigma 0.3
  } else {
    auto step =
        find_height_step(window_around(points, cell, candidate.up, parameters.half_length, parameters), parameters);
    if (!step)  // too thin to say: look farther along
      step = find_height_step(window_around(points, cell, candidate.up, kSparse * parameters.half_length, parameters),
                              parameters);
    if (!step || step->height > parameters.max_step || step->height < parameters.min_weak_step) return std::nullopt;
    if (step->face_above > kMaxFacePoints) return std::nullopt;
    const double certainty = step->height / step->sigma;
    const double contrast = step->height / step->roughness;
    if (certainty < parameters.step_sigmas || contrast < parameters.step_roughness) return std::nullopt;
    candidate.weak = step->height < parameters.min_step;
    candidate.foot = cell.at + step->foot * candidate.up;
    candidate.height = step->height;
    candidate.score = certainty;
    candidate.z = step->low_z;
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
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const TiltedCell cell = gather_tilt(points, column, row, parameters);
      if (cell.count < kMinTilted) continue;
      if (const auto candidate = test_cell(points, cell, ground, parameters)) candidates.push_back(*candidate);
    }
  }
  return candidates;
}

}  // namespace curbstone
