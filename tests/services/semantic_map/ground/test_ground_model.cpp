#include "services/semantic_map/ground/ground_model.hpp"

#include <gtest/gtest.h>

#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map::ground {
namespace {

/// What the DEM says of the middle of a tile in the middle of a cloud of 9 x 9 m.
GroundAt ground_of(const SyntheticCloud& cloud) {
  detect::cloud_map::CloudMap counts;
  detect::cloud_map::CloudMapOptions options;
  options.threads = 1;
  const auto tiles = detect::cloud_map::vote_tiles(cloud.points, options, counts);
  std::array<GroundSamples, 9> samples;
  tile::Around<GroundSamples> around;
  for (const tile::VotedTile& tile : tiles) {
    if (tile.key.x < 0 || tile.key.x > 2 || tile.key.y < 0 || tile.key.y > 2) continue;
    GroundSamples& s = samples[static_cast<std::size_t>(tile.key.y * 3 + tile.key.x)];
    s = sample_ground(tile, {});
    around.set(tile.key.x - 1, tile.key.y - 1, &s);
  }
  const GroundModel model = model_ground(around);
  tile::Around<GroundModel> models;
  models.set(0, 0, &model);
  return GroundSurface(models).at(1.5, 1.5).value_or(GroundAt{});
}

SyntheticCloud step_of(double height, double noise) {
  SyntheticCloud cloud(1, noise);
  cloud.ground(0, 0, 9, 9, 250, [=](double, double y) { return y > 4.5 ? height : 0.0; });
  return cloud;
}

TEST(GroundModel, SaysHowMuchScanLinesDisagreeAndTakesNoCurbForNoise) {
  EXPECT_NEAR(ground_of(step_of(0, 0.01)).layer_noise, 0.01, 0.004);
  EXPECT_NEAR(ground_of(step_of(0, 0.02)).layer_noise, 0.02, 0.007);
  EXPECT_NEAR(ground_of(step_of(0.12, 0.01)).layer_noise, 0.01, 0.005) << "a curb through the middle";
}

TEST(GroundModel, TwoLayersOfAWrongPoseAreNoise) {
  SyntheticCloud cloud(1, 0.005);
  cloud.ground(0, 0, 9, 9, 125, [](double, double) { return 0.0; });
  cloud.ground(0, 0, 9, 9, 125, [](double, double) { return 0.06; });
  EXPECT_GT(ground_of(cloud).layer_noise, 0.025);
}

TEST(GroundModel, TheCoarseTiltPointsUpTheStep) {
  const GroundAt ground = ground_of(step_of(0.10, 0.01));
  EXPECT_GT(ground.coarse_tilt.y(), 0.02);
  EXPECT_LT(std::abs(ground.coarse_tilt.x()), 0.01);
  EXPECT_LT(ground_of(step_of(0, 0.01)).coarse_tilt.norm(), 0.01);
}

}  // namespace
}  // namespace curbstone::semantic_map::ground
