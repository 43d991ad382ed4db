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
  EXPECT_NEAR(result.cost, 1.15, 1e-9) << "samples, evidence, columns and classes";
  EXPECT_EQ(pipeline.classes(newer.key)->curbs_utime, newer.utime);
  EXPECT_EQ(pipeline.curbs(newer.key), curbs) << "not even another copy";
}

}  // namespace
}  // namespace curbstone::semantic_map::pipeline
