#include "services/localizer/search/search_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::localizer::search {
namespace {

using Lattice = std::vector<std::uint8_t>;

constexpr int kSide = SearchRegion::side();
constexpr int kBlur = 2;         // cells around a place
constexpr double kSigma = 0.25;  // m: half a step of the search, and the accuracy of a wall in a thinned scan
constexpr int kBell = 2 * kBlur + 1;

std::array<std::uint8_t, kBell * kBell> bell() {
  std::array<std::uint8_t, kBell * kBell> out{};
  std::size_t i = 0;
  for (int y = -kBlur; y <= kBlur; ++y) {
    for (int x = -kBlur; x <= kBlur; ++x) {
      const double d2 = (x * x + y * y) * SearchRegion::kCell * SearchRegion::kCell;
      out[i++] = static_cast<std::uint8_t>(std::lround(255 * std::exp(-0.5 * d2 / (kSigma * kSigma))));
    }
  }
  return out;
}

Lattice blurred(const Lattice& standing) {
  const auto around = bell();
  Lattice out(standing.size());
  for (int y = kBlur; y < kSide - kBlur; ++y) {
    for (int x = kBlur; x < kSide - kBlur; ++x) {
      if (standing[static_cast<std::size_t>(y * kSide + x)] == 0) continue;
      std::size_t i = 0;
      for (int v = y - kBlur; v <= y + kBlur; ++v) {
        for (int u = x - kBlur; u <= x + kBlur; ++u, ++i) {
          std::uint8_t& value = out[static_cast<std::size_t>(v * kSide + u)];
          value = std::max(value, around[i]);
        }
      }
    }
  }
  return out;
}

/// The maximum of each cell and the one `step` further, first along rows, then along columns.
Lattice coarser(const Lattice& fine, int step) {
  Lattice rows(fine), out(fine.size());
  constexpr auto n = static_cast<std::size_t>(kSide);
  const auto s = static_cast<std::size_t>(step);
  for (std::size_t y = 0; y < n; ++y) {
    const std::uint8_t* from = &fine[y * n];
    std::uint8_t* to = &rows[y * n];
    for (std::size_t x = 0; x + s < n; ++x) to[x] = std::max(from[x], from[x + s]);
  }
  for (std::size_t y = 0; y < n; ++y) {
    const std::uint8_t* from = &rows[y * n];
    const std::uint8_t* other = y + s < n ? from + s * n : from;
    for (std::size_t x = 0; x < n; ++x) out[y * n + x] = std::max(from[x], other[x]);
  }
  return out;
}

std::vector<Lattice> pyramid(Lattice finest) {
  std::vector<Lattice> levels;
  levels.push_back(std::move(finest));
  for (int k = 1; k < SearchRegion::kLevels; ++k) levels.push_back(coarser(levels.back(), 1 << (k - 1)));
  return levels;
}

/// The maximum of each cell and its eight neighbours.
Lattice widened(const Lattice& road) {
  Lattice wider = coarser(coarser(road, 1), 1);
  std::rotate(wider.begin(), wider.end() - (kSide + 1), wider.end());
  return wider;
}

}  // namespace

TileKey SearchRegion::region_of(TileKey tile) {
  const auto down = [](std::int32_t v) { return v >= 0 ? v / kTilesWide : -((kTilesWide - 1 - v) / kTilesWide); };
  return {down(tile.x), down(tile.y)};
}

SearchRegion::SearchRegion(TileKey region, const fields::SavedMap& map)
    : corner_(kTileSize * kTilesWide * Eigen::Vector2d(region.x, region.y)) {
  constexpr auto kSize = static_cast<std::size_t>(kSide) * kSide;
  constexpr int kTilesAbout = static_cast<int>(kMargin * kCell / kTileSize) + 1;
  Lattice standing(kSize), road(kSize);
  for (int y = -kTilesAbout; y < kTilesWide + kTilesAbout; ++y) {
    for (int x = -kTilesAbout; x < kTilesWide + kTilesAbout; ++x) {
      const TileKey key{region.x * kTilesWide + x, region.y * kTilesWide + y};
      if (const fields::TilePlan* plan = map.plan(key)) draw(key, *plan, standing, road);
    }
  }
  upright_ = pyramid(blurred(standing));
  road_ = pyramid(widened(widened(road)));  // the vehicle may also be beside the mapped road
}

void SearchRegion::draw(TileKey tile, const fields::TilePlan& plan, Lattice& standing, Lattice& road) const {
  const Eigen::Vector2d from = kTileSize * Eigen::Vector2d(tile.x, tile.y) - corner_;
  const int first_column = static_cast<int>(std::lround(from.x() / kCellSize));
  const int first_row = static_cast<int>(std::lround(from.y() / kCellSize));
  const auto half = [](int v) { return v >= 0 ? v / 2 : -((1 - v) / 2); };
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const int x = half(first_column + column), y = half(first_row + row);
      if (std::min(x, y) < -kMargin || std::max(x, y) >= kWide + kMargin) continue;
      const auto cell = static_cast<std::size_t>(row * kCellsPerTile + column);
      if (plan.standing[cell]) standing[index(x, y)] = 1;
      if (plan.ground[cell]) road[index(x, y)] = 1;
    }
  }
}

}  // namespace curbstone::localizer::search
