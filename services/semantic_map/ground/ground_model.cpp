#include "services/semantic_map/ground/ground_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/linear/decompositions.hpp"
#include "common/statistics/quantile.hpp"

namespace curbstone::semantic_map::ground {

namespace {

constexpr int kSamplesPerSide = 3 * GroundSamples::kPerSide;  // over the 9 m
constexpr int kRoadCells = kSamplesPerSide / 2;               // of 0.5 m
constexpr double kNormalReach = 1.5;  // m: the median of the normals is taken so widely that a curb is a minority

using SampleGrid = std::array<const GroundSample*, kSamplesPerSide * kSamplesPerSide>;

constexpr std::size_t sample_index(int column, int row) {
  return static_cast<std::size_t>(row * kSamplesPerSide + column);
}

constexpr std::size_t road_index(int column, int row) {
  return static_cast<std::size_t>(row * kRoadCells + column);
}

/// The sample with its position in m from the centre tile's corner.
PlaneSample plane_sample(const GroundSample& s, int column, int row) {
  return {double{s.x} + (column / GroundSamples::kPerSide - 1) * kTileSize,
          double{s.y} + (row / GroundSamples::kPerSide - 1) * kTileSize, double{s.z}, 1.0};
}

SampleGrid sample_grid(const tile::Around<GroundSamples>& samples) {
  SampleGrid grid{};
  for (int row = 0; row < kSamplesPerSide; ++row) {
    for (int column = 0; column < kSamplesPerSide; ++column) {
      const GroundSamples* tile = samples.at(column / GroundSamples::kPerSide - 1, row / GroundSamples::kPerSide - 1);
      if (tile == nullptr) continue;
      const GroundSample& s = tile->at(column % GroundSamples::kPerSide, row % GroundSamples::kPerSide);
      if (s.count > 0) grid[sample_index(column, row)] = &s;
    }
  }
  return grid;
}

/// The range of cells along one axis, of `size` m each, that may contain samples within `reach` of a place (m from the
/// centre tile's corner), with one more cell on each side for rounding.
struct CellSpan {
  int first, last;
  CellSpan(double at, double reach, double size, int cells)
      : first(std::max(0, static_cast<int>(std::floor((at - reach + kTileSize) / size)) - 1)),
        last(std::min(cells - 1, static_cast<int>(std::floor((at + reach + kTileSize) / size)) + 1)) {}
};

CellSpan samples_about(double at, double reach) {
  return {at, reach, GroundSamples::kCell, kSamplesPerSide};
}

/// A plane fitted from below: points above it (cars, hedges) have little weight.
std::optional<Plane> rough_ground(const SampleGrid& grid) {
  std::vector<PlaneSample> samples;
  std::vector<double> heights;
  for (int row = 0; row < kSamplesPerSide; ++row) {
    for (int column = 0; column < kSamplesPerSide; ++column) {
      const GroundSample* s = grid[sample_index(column, row)];
      if (s == nullptr) continue;
      samples.push_back(plane_sample(*s, column, row));
      heights.push_back(samples.back().z);
    }
  }
  if (samples.size() < 6) return std::nullopt;
  const Plane start{quantile_in_place(heights, 0.2), Eigen::Vector2d::Zero()};
  return fit_plane(samples, start, {.scale_above = 0.2, .scale_below = 0.5, .slope_sigma = 0.10, .sample_sigma = 0.15});
}

/// The lowest sample of each 0.5 m cell (NaN: none) that is near the rough ground.
std::vector<double> lowest_samples(const SampleGrid& grid, const Plane& rough) {
  constexpr double kMaxAboveRough = 1.0;
  std::vector<double> low(static_cast<std::size_t>(kRoadCells * kRoadCells), std::numeric_limits<double>::quiet_NaN());
  for (int row = 0; row < kSamplesPerSide; ++row) {
    for (int column = 0; column < kSamplesPerSide; ++column) {
      const GroundSample* s = grid[sample_index(column, row)];
      if (s == nullptr) continue;
      const PlaneSample p = plane_sample(*s, column, row);
      if (std::abs(p.z - rough.at(p.x, p.y)) > kMaxAboveRough) continue;
      double& cell = low[road_index(column / 2, row / 2)];
      if (!(cell <= p.z)) cell = p.z;
    }
  }
  return low;
}

/// Whether a 0.5 m cell stands above the lower quarter of the cells within two of it. `around`: scratch.
bool stands_above_neighbours(const std::vector<double>& low, int column, int row, std::vector<double>& around) {
  constexpr double kMaxAboveNeighbours = 0.30;  // m
  constexpr int kReach = 2;                     // cells
  const double here = low[road_index(column, row)];
  double lowest = here;
  around.clear();
  for (int r = std::max(0, row - kReach); r <= std::min(kRoadCells - 1, row + kReach); ++r) {
    for (int c = std::max(0, column - kReach); c <= std::min(kRoadCells - 1, column + kReach); ++c) {
      const double height = low[road_index(c, r)];
      if (std::isnan(height)) continue;
      around.push_back(height);
      lowest = std::min(lowest, height);
    }
  }
  // The first test is cheap, and most cells fail it.
  return here > lowest + kMaxAboveNeighbours && here > quantile_in_place(around, 0.25) + kMaxAboveNeighbours;
}

/// The road's height in each 0.5 m cell (NaN: none) within reach of the centre tile's nodes, without cells that stand
/// above their neighbours.
std::vector<double> road_heights(const SampleGrid& grid, const Plane& rough) {
  const std::vector<double> low = lowest_samples(grid, rough);
  std::vector<double> road = low;
  std::vector<double> around;
  const int first = samples_about(0, kNormalReach).first / 2;
  const int last = samples_about(kTileSize, kNormalReach).last / 2;
  for (int row = first; row <= last; ++row) {
    for (int column = first; column <= last; ++column) {
      if (!std::isnan(low[road_index(column, row)]) && stands_above_neighbours(low, column, row, around))
        road[road_index(column, row)] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return road;
}

/// Agreement of scan lines: spread of the heights within the 0.25 m cells and between neighbouring ones, where the
/// ground is even. A curb affects a minority of the pairs and so not the quantile; scan lines displaced by a wrong pose
/// or by a single beam affect most.
double layer_noise(const SampleGrid& grid, const Plane& rough, double x, double y) {
  constexpr double kReach = 1.5;  // m
  constexpr double kQuantile = 0.7;
  constexpr double kOfPairs = 1.466;   // this quantile of |a - b|, in sigmas (normal distribution)
  constexpr double kOfSpreads = 1.10;  // and that of the RMS of a few values
  std::vector<double> spreads;
  std::vector<double> jumps;
  const CellSpan rows = samples_about(y, kReach);
  const CellSpan columns = samples_about(x, kReach);
  for (int row = rows.first; row <= rows.last; ++row) {
    for (int column = columns.first; column <= columns.last; ++column) {
      const GroundSample* s = grid[sample_index(column, row)];
      if (s == nullptr) continue;
      const PlaneSample p = plane_sample(*s, column, row);
      if (std::max(std::abs(p.x - x), std::abs(p.y - y)) > kReach) continue;
      if (s->count >= 3) spreads.push_back(double{s->spread});
      for (const auto& [dc, dr] : {std::pair(1, 0), std::pair(0, 1)}) {
        if (column + dc >= kSamplesPerSide || row + dr >= kSamplesPerSide) continue;
        const GroundSample* next = grid[sample_index(column + dc, row + dr)];
        if (next == nullptr) continue;
        const PlaneSample q = plane_sample(*next, column + dc, row + dr);
        jumps.push_back(std::abs(q.z - p.z - rough.slope.x() * (q.x - p.x) - rough.slope.y() * (q.y - p.y)));
      }
    }
  }
  const double within = spreads.empty() ? 0 : quantile_in_place(spreads, kQuantile) / kOfSpreads;
  const double between = jumps.empty() ? 0 : quantile_in_place(jumps, kQuantile) / kOfPairs;
  return std::max(within, between);
}

/// The least-squares plane through all samples within 1.5 m, relative to the rough ground: where scan lines are so far
/// apart that the vote sees only lines, it still shows the slope of the ground.
Eigen::Vector2d coarse_tilt(const std::vector<PlaneSample>& samples, const Plane& rough) {
  constexpr double kMinExtent = 0.25;  // m, standard deviation in any direction
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PlaneSample& s : samples) mean += Eigen::Vector3d(s.x, s.y, s.z) / static_cast<double>(samples.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  Eigen::Vector2d rise = Eigen::Vector2d::Zero();
  for (const PlaneSample& s : samples) {
    const Eigen::Vector2d d(s.x - mean.x(), s.y - mean.y());
    scatter += d * d.transpose();
    rise += d * (s.z - mean.z());
  }
  const double least = static_cast<double>(samples.size()) * kMinExtent * kMinExtent;
  if (!(eigen_pairs<2>(scatter).values(0) > least)) return Eigen::Vector2d::Zero();
  return Ldlt<2>(scatter).solve(rise) - rough.slope;
}

/// The samples of the road within kNormalReach of a node, m from it, and their slopes by the normals.
struct NodeSamples {
  std::vector<PlaneSample> all;
  std::vector<PlaneSample> near;  ///< within 1 m: what the plane is fitted to
  std::vector<double> slopes_x;   ///< of `all`
  std::vector<double> slopes_y;
};

NodeSamples samples_of_road(const SampleGrid& grid, const std::vector<double>& road, double x, double y) {
  constexpr double kPlaneReach = 1.0;     // m
  constexpr double kMaxAboveRoad = 0.30;  // m
  NodeSamples samples;
  const CellSpan rows = samples_about(y, kNormalReach);
  const CellSpan columns = samples_about(x, kNormalReach);
  for (int row = rows.first; row <= rows.last; ++row) {
    for (int column = columns.first; column <= columns.last; ++column) {
      const GroundSample* s = grid[sample_index(column, row)];
      if (s == nullptr) continue;
      PlaneSample p = plane_sample(*s, column, row);
      p.x -= x;
      p.y -= y;
      const double away = std::max(std::abs(p.x), std::abs(p.y));
      if (away > kNormalReach) continue;
      if (!(p.z <= road[road_index(column / 2, row / 2)] + kMaxAboveRoad)) continue;
      samples.all.push_back(p);
      samples.slopes_x.push_back(double{s->slope_x});
      samples.slopes_y.push_back(double{s->slope_y});
      if (away <= kPlaneReach) samples.near.push_back(p);
    }
  }
  return samples;
}

/// The median slope by the normals, and its spread (1 sigma, from the median deviation).
void judge_normals(std::vector<double>& slopes_x, std::vector<double>& slopes_y, GroundNode& node) {
  node.normal_slope = {quantile_in_place(slopes_x, 0.5), quantile_in_place(slopes_y, 0.5)};
  for (double& s : slopes_x) s = std::abs(s - node.normal_slope.x());
  for (double& s : slopes_y) s = std::abs(s - node.normal_slope.y());
  node.normal_noise = 1.4826 * std::max(quantile_in_place(slopes_x, 0.5), quantile_in_place(slopes_y, 0.5));
}

/// A robust plane, started at the median height with the slope of the rough ground.
Plane fit_ground(const std::vector<PlaneSample>& samples, const Plane& rough) {
  std::vector<double> heights;
  heights.reserve(samples.size());
  for (const PlaneSample& s : samples) heights.push_back(s.z - rough.slope.x() * s.x - rough.slope.y() * s.y);
  const Plane start{quantile_in_place(heights, 0.5), rough.slope};
  return fit_plane(samples, start,
                   {.scale_above = 0.05, .scale_below = 0.05, .slope_sigma = 0.05, .sample_sigma = 0.05});
}

/// The plane and the normals of the 1 m cell about (x, y).
GroundNode refine(const SampleGrid& grid, const std::vector<double>& road, const Plane& rough, double x, double y) {
  constexpr std::size_t kMinSamples = 4;
  NodeSamples samples = samples_of_road(grid, road, x, y);
  GroundNode node;
  if (samples.near.size() < kMinSamples) return node;
  node.valid = true;
  node.plane = fit_ground(samples.near, rough);
  judge_normals(samples.slopes_x, samples.slopes_y, node);
  node.layer_noise = layer_noise(grid, rough, x, y);
  node.coarse_tilt = coarse_tilt(samples.all, rough);
  return node;
}

}  // namespace

GroundModel model_ground(const tile::Around<GroundSamples>& samples) {
  GroundModel model;
  const SampleGrid grid = sample_grid(samples);
  model.road.fill(std::numeric_limits<float>::quiet_NaN());
  const auto rough = rough_ground(grid);
  model.rough = rough;
  if (!rough) return model;
  const std::vector<double> road = road_heights(grid, *rough);
  constexpr int n = GroundModel::kRoadPerSide;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column)
      model.road[static_cast<std::size_t>(row * n + column)] =
          static_cast<float>(road[road_index(column + n, row + n)]);
  }
  for (int row = 0; row < GroundModel::kPerSide; ++row) {
    for (int column = 0; column < GroundModel::kPerSide; ++column) {
      model.nodes[static_cast<std::size_t>(row * GroundModel::kPerSide + column)] =
          refine(grid, road, *rough, (column + 0.5) * GroundModel::kCell, (row + 0.5) * GroundModel::kCell);
    }
  }
  return model;
}

GroundSurface::GroundSurface(const tile::Around<GroundModel>& models) {
  if (models.centre() != nullptr) rough_ = models.centre()->rough;
  for (int row = 0; row < kNodes; ++row) {
    for (int column = 0; column < kNodes; ++column) {
      const GroundModel* model = models.at(column / GroundModel::kPerSide - 1, row / GroundModel::kPerSide - 1);
      if (model == nullptr) continue;
      const GroundNode& node = model->at(column % GroundModel::kPerSide, row % GroundModel::kPerSide);
      if (node.valid) nodes_[static_cast<std::size_t>(row * kNodes + column)] = &node;
    }
  }
}

/// Calls visit(weight, node, dx, dy) for the up to four nodes around; returns the sum of the weights.
template <class Visit>
double GroundSurface::blend(double x, double y, Visit visit) const {
  const double column = (x + kTileSize) / GroundModel::kCell - 0.5;
  const double row = (y + kTileSize) / GroundModel::kCell - 0.5;
  // Truncation rounds down here, because values below 0 are clamped.
  const int c0 = std::clamp(static_cast<int>(column), 0, kNodes - 2);
  const int r0 = std::clamp(static_cast<int>(row), 0, kNodes - 2);
  const double fx = std::clamp(column - c0, 0.0, 1.0);
  const double fy = std::clamp(row - r0, 0.0, 1.0);
  double sum = 0;
  for (int r = 0; r < 2; ++r) {
    for (int c = 0; c < 2; ++c) {
      const GroundNode* node = nodes_[static_cast<std::size_t>((r0 + r) * kNodes + c0 + c)];
      const double weight = (c == 0 ? 1 - fx : fx) * (r == 0 ? 1 - fy : fy);
      if (node == nullptr || weight <= 0) continue;
      visit(weight, *node, (column - c0 - c) * GroundModel::kCell, (row - r0 - r) * GroundModel::kCell);
      sum += weight;
    }
  }
  return sum;
}

std::optional<GroundAt> GroundSurface::at(double x, double y) const {
  GroundAt ground;
  const double sum = blend(x, y, [&](double weight, const GroundNode& node, double dx, double dy) {
    ground.height += weight * node.plane.at(dx, dy);
    ground.normal_slope += weight * node.normal_slope;
    ground.normal_noise += weight * node.normal_noise;
    ground.layer_noise += weight * node.layer_noise;
    ground.coarse_tilt += weight * node.coarse_tilt;
  });
  if (sum <= 0) return std::nullopt;
  ground.height /= sum;
  ground.normal_slope /= sum;
  ground.normal_noise /= sum;
  ground.layer_noise /= sum;
  ground.coarse_tilt /= sum;
  return ground;
}

std::optional<GroundBelow> GroundSurface::below(double x, double y) const {
  Eigen::Array2d height_noise = Eigen::Array2d::Zero();
  Eigen::Array2d slope = Eigen::Array2d::Zero();
  const double sum = blend(x, y, [&](double weight, const GroundNode& node, double dx, double dy) {
    height_noise += weight * Eigen::Array2d(node.plane.at(dx, dy), node.normal_noise);
    slope += weight * node.normal_slope.array();
  });
  if (sum <= 0) return std::nullopt;
  height_noise /= sum;
  return GroundBelow{height_noise(0), slope / sum, height_noise(1)};
}

std::optional<double> GroundSurface::height(double x, double y) const {
  double height = 0;
  const double sum = blend(x, y, [&](double weight, const GroundNode& node, double dx, double dy) {
    height += weight * node.plane.at(dx, dy);
  });
  return sum > 0 ? std::optional(height / sum) : std::nullopt;
}

std::optional<double> GroundSurface::height_or_rough(double x, double y) const {
  if (const auto refined = height(x, y)) return refined;
  return rough_ ? std::optional(rough_->at(x, y)) : std::nullopt;
}

}  // namespace curbstone::semantic_map::ground
