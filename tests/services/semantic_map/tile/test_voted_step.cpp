#include <gtest/gtest.h>

#include "services/semantic_map/tile/voted_tile_assembler.hpp"

namespace curbstone::semantic_map::tile {
namespace {

/// A page of the tensor of one point, and of the points themselves if it `brings` them.
VotedStep step_of(std::int32_t base, std::int32_t total, std::int32_t brings, std::int32_t point) {
  voted_points_t page{};
  page.chain = 7;
  page.base = base;
  page.revision = base + 1;
  page.num_pages = 1;
  page.total = total;
  page.num_points = page.num_voters = brings;
  page.x.assign(static_cast<std::size_t>(brings), 1);
  page.y = page.z = page.x;
  page.intensity.assign(page.x.size(), 0);
  for (std::int32_t i = 0; i < brings; ++i) page.voter.push_back(0);
  page.num_scales = 1;
  page.sigma = {0.3F};
  page.num_tensors = 1;
  page.scale = {0};
  page.point = {point};
  page.normal_x = page.normal_y = {0};
  page.normal_z = {32767};
  page.tangent_x = page.tangent_y = page.tangent_z = {0};
  page.stick = page.plate = {0};
  page.mass = {9};
  return {{}, page.chain, page.base, page.revision, {page}};
}

TEST(VotedStep, ATensorIsThatOfAllPointsOfItsVoter) {
  VotedTile tile;
  take_step(step_of(0, 3, 3, 0), tile);
  ASSERT_EQ(tile.points.size(), 3U);
  EXPECT_EQ(tile.points.tensors().size(), 1U);
  for (const VotedPoint& p : tile.points) EXPECT_EQ(p.mass, 9);
}

TEST(VotedStep, ATensorOfAPointThatNeverCameChangesNothing) {
  Counters counters;
  for (const std::int32_t base : {0, 1}) {
    VotedTile tile;
    if (base > 0) take_step(step_of(0, 3, 3, 0), tile);
    const std::size_t before = tile.points.size();
    const VotedStep empty = step_of(base, 300'000, 0, 299'999);
    const auto step = VotedTileAssembler().add(empty.pages[0], counters);
    ASSERT_TRUE(step) << "it adds up";
    ASSERT_TRUE(continues(*step, &tile));
    take_step(*step, tile);
    EXPECT_EQ(tile.points.size(), before);
  }
}

}  // namespace
}  // namespace curbstone::semantic_map::tile
