#include "services/semantic_map/ground/ground_samples.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace curbstone::semantic_map::ground {

namespace {

constexpr float kLayer = 0.12F;        // m: what lies this close above the lowest point is one layer
constexpr float kOutlierShare = 0.1F;  // of a cell's points that may be too low (multiple reflections)

GroundSample lowest_layer(std::vector<const tile::VotedPoint*>& points) {
  std::sort(points.begin(), points.end(),
            [](const tile::VotedPoint* a, const tile::VotedPoint* b) { return a->z < b->z; });
  const float low = points[static_cast<std::size_t>(kOutlierShare * static_cast<float>(points.size()))]->z;
  double sums[5] = {};
  int count = 0;
  for (const tile::VotedPoint* p : points) {
    if (p->z > low + kLayer) break;
    if (p->z < low - kLayer) continue;
    const auto nz = static_cast<double>(p->normal.z());
    const double values[5] = {double{p->x}, double{p->y}, double{p->z}, -double{p->normal.x()} / nz,
                              -double{p->normal.y()} / nz};
    for (int k = 0; k < 5; ++k) sums[k] += values[k];
    ++count;
  }
  const auto mean = [&](int k) { return static_cast<float>(sums[k] / count); };
  double squares = 0;
  for (const tile::VotedPoint* p : points) {
    if (p->z > low + kLayer) break;
    if (p->z < low - kLayer) continue;
    const float off = p->z - mean(2) - mean(3) * (p->x - mean(0)) - mean(4) * (p->y - mean(1));
    squares += double{off} * double{off};
  }
  const auto spread = static_cast<float>(std::sqrt(squares / std::max(1, count - 1)));
  return {mean(0), mean(1), mean(2), mean(3), mean(4), spread, count};
}

}  // namespace

GroundSamples sample_ground(const tile::VotedTile& tile, const tile::CurbParameters& parameters) {
  constexpr int n = GroundSamples::kPerSide;
  std::array<std::vector<const tile::VotedPoint*>, n * n> cells;
  for (const tile::VotedPoint& p : tile.points) {
    if (!may_be_ground(p, parameters)) continue;
    const int column = std::clamp(static_cast<int>(double{p.x} / GroundSamples::kCell), 0, n - 1);
    const int row = std::clamp(static_cast<int>(double{p.y} / GroundSamples::kCell), 0, n - 1);
    cells[static_cast<std::size_t>(row * n + column)].push_back(&p);
  }
  GroundSamples samples;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].empty()) samples.cells[i] = lowest_layer(cells[i]);
  }
  return samples;
}

}  // namespace curbstone::semantic_map::ground
