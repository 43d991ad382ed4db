#include "services/semantic_map/curbs/near_ground_points.hpp"

#include <cmath>
#include <span>

#include "services/semantic_map/curbs/height_step.hpp"
#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kWindowMargin = NearGroundPoints::kMarginCells * kCellSize;  // m: as far as a window reaches
constexpr double kBelowGround = 0.30;                                         // m: lower points are strays
constexpr float kThinMass = 10;       // of the vote; even ground at sigma 0.3 m, thinned to 0.1 m, has 27
constexpr double kMinNormalZ = 0.35;  // steeper is a wall, not a curb at this scale

constexpr int kNowhere = -1;
constexpr int kSide = NearGroundPoints::kSide;

bool is_of_tile(int cell) {
  const auto is_inner = [](int k) {
    return k >= NearGroundPoints::kMarginCells && k < NearGroundPoints::kMarginCells + kCellsPerTile;
  };
  return is_inner(cell % kSide) && is_inner(cell / kSide);
}

/// The cell of each of n points; kNowhere for points that are not near the ground, or where no ground is known.
CURBSTONE_VECTORISED
void find_cells(const double* x, const double* y, const double* z, const double* ground, std::size_t n,
                double max_above, int* __restrict cells) {
  const auto cell_along = [](double at) __attribute__((always_inline)) {
    const int cell = static_cast<int>((at + kWindowMargin) / kCellSize);
    const int most = cell < kSide - 1 ? cell : kSide - 1;
    return most < 0 ? 0 : most;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double above = z[i] - ground[i];
    const bool is_near = (above >= -kBelowGround) & (above <= max_above);
    const int cell = cell_along(y[i]) * kSide + cell_along(x[i]);
    cells[i] = is_near ? cell : kNowhere;
  }
}

/// ground::may_be_ground() without branches, because they would be mispredicted.
bool carries_a_side(const tile::VotedTensor& point, const tile::CurbParameters& parameters) {
  return (point.mass > 0) & (static_cast<double>(point.normal.z()) >= parameters.min_normal_z) &
         ((static_cast<double>(point.stick) >= parameters.min_stick) | ground::is_scan_line(point));
}

static_assert(kWindowMargin <= ground::GroundColumns::kReach);

}  // namespace

void NearGroundPoints::gather(const tile::Around<tile::VotedTile>& tiles, const ground::GroundSurface& ground,
                              const tile::CurbParameters& parameters) {
  const ground::GroundColumns columns(ground);
  find_places(tiles);
  columns.heights(at_x_.data(), at_y_.data(), n_, ground_.data());
  sort(parameters);
  describe(columns, parameters);
}

/// Collects the points within the margin, without a branch, because most of the neighbours' points are outside in an
/// order that would be mispredicted: a point that is left out is overwritten by the next.
void NearGroundPoints::find_places(const tile::Around<tile::VotedTile>& tiles) {
  n_ = 0;
  tiles.for_each([&](const tile::VotedTile& tile, double dx, double dy) {
    const auto points = tile.points.places();
    const tile::VotedTensor* const tensors = tile.points.tensors().data();
    if (const std::size_t most = n_ + points.size() + 1; at_x_.size() < most) {
      for (std::vector<double>* column : {&at_x_, &at_y_, &at_z_, &ground_}) column->resize(most);
      tensors_.resize(most);
      cells_.resize(most);
      near_.resize(most);
    }
    double* const at_x = at_x_.data();
    double* const at_y = at_y_.data();
    double* const at_z = at_z_.data();
    const tile::VotedTensor** const tensor = tensors_.data();
    std::size_t n = n_;
    for (const tile::VotedPoints::Place& p : points) {
      const double x = double{p.x} + dx;
      const double y = double{p.y} + dy;
      at_x[n] = x;
      at_y[n] = y;
      at_z[n] = double{p.z};
      tensor[n] = tensors + p.tensor;
      const bool is_in = (x >= -kWindowMargin) & (y >= -kWindowMargin) & (x < kTileSize + kWindowMargin) &
                         (y < kTileSize + kWindowMargin);
      n += is_in ? 1U : 0U;
    }
    n_ = n;
  });
}

/// Sorts the points near the ground by cells (counting sort).
void NearGroundPoints::sort(const tile::CurbParameters& parameters) {
  find_cells(at_x_.data(), at_y_.data(), at_z_.data(), ground_.data(), n_, parameters.max_step, cells_.data());
  std::size_t num_near = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    near_[num_near] = static_cast<std::uint32_t>(i);
    num_near += cells_[i] != kNowhere ? 1U : 0U;
  }
  const std::span<const std::uint32_t> near = std::span(near_).first(num_near);
  start_.assign(static_cast<std::size_t>(kSide * kSide) + 1, 0);
  for (const std::uint32_t i : near) ++start_[static_cast<std::size_t>(cells_[i]) + 1];
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  if (described_.size() < num_near) {
    described_.resize(num_near);
    for (std::vector<double>* column : {&x_, &y_, &z_, &unfit_}) column->resize(num_near + kPadding);
  }
  next_.assign(start_.begin(), start_.end() - 1);
  inner_.clear();
  inner_x_.clear();
  inner_y_.clear();
  for (const std::uint32_t i : near) {
    const int cell = cells_[i];
    const auto at = static_cast<std::size_t>(next_[static_cast<std::size_t>(cell)]++);
    x_[at] = double{static_cast<float>(at_x_[i])};
    y_[at] = double{static_cast<float>(at_y_[i])};
    z_[at] = double{static_cast<float>(at_z_[i] - ground_[i])};
    unfit_[at] = carries_a_side(*tensors_[i], parameters) ? 0 : StepWindow::kUnfit;
    if (!is_of_tile(cell)) continue;
    inner_.push_back({at, tensors_[i]});
    inner_x_.push_back(at_x_[i]);
    inner_y_.push_back(at_y_[i]);
  }
}

/// Computes the tilt of the tile's own points relative to the ground.
void NearGroundPoints::describe(const ground::GroundColumns& ground, const tile::CurbParameters& parameters) {
  for (std::vector<double>* column : {&slope_x_, &slope_y_, &noise_}) {
    if (column->size() < inner_.size()) column->resize(inner_.size());
  }
  ground.normals(inner_x_.data(), inner_y_.data(), inner_.size(), slope_x_.data(), slope_y_.data(), noise_.data());
  for (std::size_t i = 0; i < inner_.size(); ++i) {
    const tile::VotedTensor& p = *inner_[i].tensor;
    const std::size_t at = inner_[i].index;
    NearGround n{.x = static_cast<float>(inner_x_[i]), .y = static_cast<float>(inner_y_[i])};
    n.is_line = ground::is_scan_line(p) || p.mass < kThinMass;
    const auto nz = static_cast<double>(p.normal.z());
    if (p.mass > 0 && nz >= kMinNormalZ) {
      const Eigen::Vector2d tilt = Eigen::Vector2d(-double{p.normal.x()}, -double{p.normal.y()}) / nz -
                                   Eigen::Vector2d(slope_x_[i], slope_y_[i]);
      n.tilt_x = static_cast<float>(tilt.x());
      n.tilt_y = static_cast<float>(tilt.y());
      n.tilted = tilt.norm() > std::max(parameters.min_tilt, parameters.tilt_sigmas * noise_[i]);
    }
    described_[at] = n;
  }
}

}  // namespace curbstone::semantic_map::curbs
