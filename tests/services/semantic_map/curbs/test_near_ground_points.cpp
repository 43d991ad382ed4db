#include "services/semantic_map/curbs/near_ground_points.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "services/semantic_map/curbs/height_step.hpp"

namespace curbstone::semantic_map::curbs {
namespace {

constexpr int kMargin = NearGroundPoints::kMarginCells;

/// Nine tiles with points in random places, on ground that is known in part.
struct RandomTiles {
  explicit RandomTiles(unsigned seed) : random(seed) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto i = static_cast<std::size_t>((dy + 1) * 3 + dx + 1);
        for (ground::GroundNode& node : models[i].nodes) {
          node.valid = uniform(0, 1) < 0.9;
          node.plane = {uniform(-0.1, 0.1), {uniform(-0.1, 0.1), uniform(-0.1, 0.1)}};
          node.normal_slope = {uniform(-0.1, 0.1), uniform(-0.1, 0.1)};
          node.normal_noise = uniform(0, 0.05);
        }
        around_models.set(dx, dy, &models[i]);
        if (uniform(0, 1) < 0.1) continue;  // a tile that is not there
        grow(tiles[i], 600);
        around.set(dx, dy, &tiles[i]);
      }
    }
  }
  void grow(tile::VotedTile& tile, int count) {
    for (int k = 0; k < count; ++k) {
      tile::VotedPoint p;
      p.x = static_cast<float>(std::floor(uniform(0, kStepsPerTile)) * kPositionStep);
      p.y = static_cast<float>(std::floor(uniform(0, kStepsPerTile)) * kPositionStep);
      p.z = static_cast<float>(uniform(-0.5, 0.8));
      p.normal = Eigen::Vector3f(static_cast<float>(uniform(-0.3, 0.3)), static_cast<float>(uniform(-0.3, 0.3)), 1)
                     .normalized();
      p.stick = static_cast<float>(uniform(0, 1));
      p.plate = static_cast<float>(uniform(0, 1));
      p.mass = uniform(0, 1) < 0.1 ? 0.0F : static_cast<float>(uniform(0, 30));
      tile.points.push_back(p);
    }
  }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

  std::mt19937 random;
  std::array<tile::VotedTile, 9> tiles;
  std::array<ground::GroundModel, 9> models;
  tile::Around<tile::VotedTile> around;
  tile::Around<ground::GroundModel> around_models;
};

struct Expected {
  double x, y, z, unfit;
  NearGround described;
};

/// The same, point by point: what lies in one cell, in the order of the tiles.
std::vector<Expected> points_of_cell(const RandomTiles& tiles, int column, int row) {
  const tile::CurbParameters parameters;
  const ground::GroundSurface ground(tiles.around_models);
  std::vector<Expected> result;
  tiles.around.for_each([&](const tile::VotedTile& tile, double dx, double dy) {
    for (const tile::VotedPoint& p : tile.points) {
      const double x = double{p.x} + dx;
      const double y = double{p.y} + dy;
      const double margin = kMargin * kCellSize;
      if (x < -margin || y < -margin || x >= kTileSize + margin || y >= kTileSize + margin) continue;
      if (static_cast<int>((x + margin) / kCellSize) != column + kMargin ||
          static_cast<int>((y + margin) / kCellSize) != row + kMargin)
        continue;
      const auto below = ground.below(x, y);
      if (!below) continue;
      const double above = double{p.z} - below->height;
      if (above < -0.30 || above > parameters.max_step) continue;
      Expected e{double{static_cast<float>(x)},
                 double{static_cast<float>(y)},
                 double{static_cast<float>(above)},
                 ground::may_be_ground(p, parameters) ? 0 : StepWindow::kUnfit,
                 {}};
      e.described.x = static_cast<float>(x);
      e.described.y = static_cast<float>(y);
      e.described.is_line = ground::is_scan_line(p) || p.mass < 10;
      const auto nz = static_cast<double>(p.normal.z());
      if (p.mass > 0 && nz >= 0.35) {
        const Eigen::Vector2d tilt =
            Eigen::Vector2d(-double{p.normal.x()}, -double{p.normal.y()}) / nz - below->normal_slope;
        e.described.tilt_x = static_cast<float>(tilt.x());
        e.described.tilt_y = static_cast<float>(tilt.y());
        e.described.tilted = tilt.norm() > std::max(parameters.min_tilt, parameters.tilt_sigmas * below->normal_noise);
      }
      result.push_back(e);
    }
  });
  return result;
}

void expect_same_cell(const NearGroundPoints& points, const RandomTiles& tiles, int column, int row) {
  const std::vector<Expected> expected = points_of_cell(tiles, column, row);
  const auto [begin, end] = points.range(column, column, row);
  ASSERT_EQ(end - begin, expected.size()) << column << ", " << row;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(points.x()[begin + i], expected[i].x);
    EXPECT_EQ(points.y()[begin + i], expected[i].y);
    EXPECT_EQ(points.z()[begin + i], expected[i].z);
    EXPECT_EQ(points.unfit()[begin + i], expected[i].unfit);
  }
  if (column < 0 || row < 0 || column >= kCellsPerTile || row >= kCellsPerTile) return;
  std::size_t i = 0;
  points.for_cell(column, row, [&](const NearGround& n) { EXPECT_EQ(n, expected[i++].described); });
}

/// One object for all, as in the semantic map: nothing of an earlier tile, or of fewer points, may be left.
TEST(NearGroundPoints, AreThoseThatOneFindsPointByPointToTheBitHoweverTilesChange) {
  NearGroundPoints points;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    RandomTiles tiles(seed);
    for (int change = 0; change < 4; ++change) {
      const auto which = static_cast<std::size_t>(tiles.uniform(0, 9));
      tiles.grow(tiles.tiles[which], 40);
      if (change == 2) tiles.tiles[which].points.shorten(100);
      tiles.models[which].nodes[4].plane.height += 0.01;
      points.gather(tiles.around, ground::GroundSurface(tiles.around_models), {});
      for (int row = -kMargin; row < kCellsPerTile + kMargin; row += 2) {
        for (int column = -kMargin; column < kCellsPerTile + kMargin; ++column)
          expect_same_cell(points, tiles, column, row);
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::semantic_map::curbs
