#include "services/semantic_map/curbs/near_ground_points.hpp"

#include <cmath>

#include "services/semantic_map/curbs/height_step.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kWindowMargin = NearGroundPoints::kMarginCells * kCellSize;  // m: as far as a window reaches
constexpr double kBelowGround = 0.30;                                         // m: what is lower is a stray
constexpr float kThinMass = 10;       // of the vote; even ground at sigma 0.3 m, thinned to 0.1 m, has 27
constexpr double kMinNormalZ = 0.35;  // steeper is no curb at this scale, it is a wall

/// Its tilt against the ground.
void describe(const tile::VotedTensor& p, const ground::GroundBelow& g, const tile::CurbParameters& parameters,
              NearGround& n) {
  n.is_line = ground::is_scan_line(p) || p.mass < kThinMass;
  const auto nz = static_cast<double>(p.normal.z());
  if (p.mass <= 0 || nz < kMinNormalZ) return;
  const Eigen::Vector2d tilt = Eigen::Vector2d(-double{p.normal.x()}, -double{p.normal.y()}) / nz - g.normal_slope;
  n.tilt_x = static_cast<float>(tilt.x());
  n.tilt_y = static_cast<float>(tilt.y());
  n.tilted = tilt.norm() > std::max(parameters.min_tilt, parameters.tilt_sigmas * g.normal_noise);
}

}  // namespace

void NearGroundPoints::gather(const tile::Around<tile::VotedTile>& tiles, const ground::GroundSurface& ground,
                              const tile::CurbParameters& parameters) {
  const auto cell = [](double x) {
    return std::clamp(static_cast<int>((x + kWindowMargin) / kCellSize), 0, kSide - 1);
  };
  const auto is_in_tile = [](int cell) { return cell >= kMarginCells && cell < kMarginCells + kCellsPerTile; };
  gathered_.clear();
  tiles.for_each([&](const tile::VotedTile& tile, double dx, double dy) {
    for (const tile::VotedPoints::Place& p : tile.points.places()) {
      const double x = double{p.x} + dx;
      const double y = double{p.y} + dy;
      if (x < -kWindowMargin || y < -kWindowMargin || x >= kTileSize + kWindowMargin || y >= kTileSize + kWindowMargin)
        continue;
      const int column = cell(x);
      const int row = cell(y);
      const tile::VotedTensor& tensor = tile.points.tensors()[p.tensor];
      NearGround n{.x = static_cast<float>(x), .y = static_cast<float>(y)};
      const auto put = [&](double height) {
        const double above = double{p.z} - height;
        if (above < -kBelowGround || above > parameters.max_step) return false;
        n.z = static_cast<float>(above);
        n.is_ground = ground::may_be_ground(tensor, parameters);
        return true;
      };
      if (is_in_tile(column) && is_in_tile(row)) {
        const auto g = ground.below(x, y);
        if (!g || !put(g->height)) continue;
        describe(tensor, *g, parameters, n);
      } else {
        const auto height = ground.height(x, y);
        if (!height || !put(*height)) continue;
      }
      gathered_.push_back({n, row * kSide + column});
    }
  });
  sort();
}

/// By counting.
void NearGroundPoints::sort() {
  start_.assign(static_cast<std::size_t>(kSide * kSide) + 1, 0);
  for (const Gathered& g : gathered_) ++start_[static_cast<std::size_t>(g.cell) + 1];
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  if (described_.size() < gathered_.size()) {
    described_.resize(gathered_.size());
    for (std::vector<double>* column : {&x_, &y_, &z_, &unfit_}) column->resize(gathered_.size() + kPadding);
  }
  next_.assign(start_.begin(), start_.end() - 1);
  for (const auto& [point, cell] : gathered_) {
    const auto at = static_cast<std::size_t>(next_[static_cast<std::size_t>(cell)]++);
    described_[at] = point;
    x_[at] = double{point.x};
    y_[at] = double{point.y};
    z_[at] = double{point.z};
    unfit_[at] = point.is_ground ? 0 : StepWindow::kUnfit;
  }
}

}  // namespace curbstone::semantic_map::curbs
