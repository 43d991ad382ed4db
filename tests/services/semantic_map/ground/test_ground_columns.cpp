#include "services/semantic_map/ground/ground_columns.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace curbstone::semantic_map::ground {
namespace {

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}

/// Random ground over nine tiles, some of whose nodes are missing, and some of which are missing altogether.
class PatchyGround {
 public:
  explicit PatchyGround(unsigned seed) : random_(seed) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (uniform(0, 1) < 0.2) continue;
        models_.push_back(std::make_unique<GroundModel>());
        for (GroundNode& node : models_.back()->nodes) {
          node.valid = uniform(0, 1) < 0.7;
          node.plane = {uniform(-20, 20), {uniform(-0.2, 0.2), uniform(-0.2, 0.2)}};
          node.normal_slope = {uniform(-0.2, 0.2), uniform(-0.2, 0.2)};
          node.normal_noise = uniform(0, 0.1);
        }
        around_.set(dx, dy, models_.back().get());
      }
    }
  }
  [[nodiscard]] GroundSurface surface() const { return GroundSurface(around_); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

 private:
  std::mt19937 random_;
  std::vector<std::unique_ptr<GroundModel>> models_;
  tile::Around<GroundModel> around_;
};

TEST(GroundColumns, SayOfEachPlaceWhatTheSurfaceSaysToTheBit) {
  int seen = 0;
  int unseen = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    PatchyGround ground(seed);
    std::vector<double> x, y;
    for (int i = 0; i < 503; ++i) {
      x.push_back(ground.uniform(-GroundColumns::kReach, kTileSize + GroundColumns::kReach));
      y.push_back(ground.uniform(-GroundColumns::kReach, kTileSize + GroundColumns::kReach));
      if (i % 5 == 0) x.back() = 0.5 * std::round(2 * x.back());  // on a node's line, or between two
      if (i % 7 == 0) y.back() = 0.5 * std::round(2 * y.back());
    }
    const GroundSurface surface = ground.surface();
    const GroundColumns columns(surface);
    const std::size_t n = x.size();
    std::vector<double> height(n), slope_x(n), slope_y(n), noise(n);
    columns.heights(x.data(), y.data(), n, height.data());
    columns.normals(x.data(), y.data(), n, slope_x.data(), slope_y.data(), noise.data());
    for (std::size_t i = 0; i < n; ++i) {
      const auto below = surface.below(x[i], y[i]);
      if (!below) {
        EXPECT_TRUE(std::isnan(height[i]) && std::isnan(slope_x[i]) && std::isnan(slope_y[i]) && std::isnan(noise[i]));
        ++unseen;
        continue;
      }
      ++seen;
      EXPECT_EQ(bits(height[i]), bits(*surface.height(x[i], y[i])));
      EXPECT_EQ(bits(height[i]), bits(below->height));
      EXPECT_EQ(bits(slope_x[i]), bits(below->normal_slope.x()));
      EXPECT_EQ(bits(slope_y[i]), bits(below->normal_slope.y()));
      EXPECT_EQ(bits(noise[i]), bits(below->normal_noise));
    }
  }
  EXPECT_GT(seen, 5000);
  EXPECT_GT(unseen, 200);
}

}  // namespace
}  // namespace curbstone::semantic_map::ground
