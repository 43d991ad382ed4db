#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map::pipeline {
namespace {

TEST(PipelineCurbs, OfTheSameEvidenceAreNotLookedForAgainButAreKnownToBeNewer) {
  SyntheticCloud cloud;
  cloud.ground(-6, -6, 6, 6, 150, [](double, double y) { return y > 1 ? 0.1 : 0.0; });
  detect::cloud_map::CloudMap counts;
  detect::cloud_map::CloudMapOptions options;
  options.threads = 1;
  const std::vector<tile::VotedTile> tiles = detect::cloud_map::vote_tiles(cloud.points, options, counts);
  TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  tile::VotedTile newer = tiles[tiles.size() / 2];
  const auto curbs = pipeline.curbs(newer.key);
  newer.utime += 1000;
  pipeline.set_voted(newer);
  const WorkResult result = pipeline.run({TileWork::Kind::kUpdate, newer.key});
  EXPECT_EQ(result.changed, std::set<TileKey>{newer.key});
  EXPECT_GT(result.cost, 0.25) << "samples, evidence, columns and classes";
  EXPECT_EQ(pipeline.classes(newer.key)->curbs_utime, newer.utime);
  EXPECT_EQ(pipeline.curbs(newer.key), curbs) << "not even another copy";
}

TEST(PipelineCurbs, CostWhatTheirSearchLookedAt) {
  SyntheticCloud cloud;
  cloud.ground(-6, -6, 6, 6, 150, [](double, double y) { return y > 1 ? 0.1 : 0.0; });
  detect::cloud_map::CloudMap counts;
  detect::cloud_map::CloudMapOptions options;
  options.threads = 1;
  TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : detect::cloud_map::vote_tiles(cloud.points, options, counts))
    pipeline.set_voted(tile);
  const auto cost_of_update = [&](TileKey key) { return pipeline.run({TileWork::Kind::kUpdate, key}).cost; };
  const double with_curb = cost_of_update({0, 0});
  const double without = cost_of_update({0, -2});
  EXPECT_GT(with_curb, 1.5 * without);
  EXPECT_GE(without, 0.45) << "samples, ground, columns and classes are not counted";
  EXPECT_EQ(cost_of_update({0, 0}), 0) << "of the same there is nothing to do";
}

}  // namespace
}  // namespace curbstone::semantic_map::pipeline
