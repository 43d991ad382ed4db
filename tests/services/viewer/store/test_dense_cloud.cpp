#include "services/viewer/store/dense_cloud.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/services/viewer/cloud_messages.hpp"

namespace curbstone::viewer::store {
namespace {

using Put = DenseCloud::Put;

class DenseCloudTest : public ::testing::Test {
 protected:
  DenseCloudTest() { cloud_.look(3, {{0, 0, DenseCloud::kReach}}); }
  [[nodiscard]] const DenseCloud::Tile& tile(TileKey key = {0, 0}) const { return cloud_.tiles().at(key); }
  DenseCloud cloud_;
};

TEST_F(DenseCloudTest, KeepsOnePointOfAVoxel) {
  map_points_t message = records({0, 0}, 0, 3);
  message.x = {100, 149, 150};
  message.y = message.z = {0, 0, 0};
  EXPECT_EQ(cloud_.put(message), Put::kTaken);
  ASSERT_EQ(tile().slots.size(), 2U);
  EXPECT_EQ(tile().slots[0].point.x, 100);
  EXPECT_EQ(tile().slots[1].point.x, 150);
  EXPECT_EQ(tile().z_origin, 1);
}

TEST_F(DenseCloudTest, WhatComesTwiceChangesNothingAndWhatWasRemovedStaysAway) {
  cloud_.put(records({0, 0}, 0, 10));
  const auto number = tile().number;
  EXPECT_EQ(cloud_.put(records({0, 0}, 0, 10)), Put::kIgnored);
  EXPECT_EQ(tile().number, number);
  map_points_t removal = records({0, 0}, 10, 1);
  removal.x[0] = -1 - 60;
  removal.y[0] = 0;
  EXPECT_EQ(cloud_.put(removal), Put::kTaken);
  ASSERT_EQ(tile().slots.size(), 9U);
  EXPECT_GT(tile().number, number);
  EXPECT_EQ(tile().slots[0].point.x, 600) << "the last one moved there";
  EXPECT_EQ(tile().slots[0].number, tile().number);
  cloud_.put(records({0, 0}, 0, 10));
  EXPECT_EQ(tile().slots.size(), 9U);
  cloud_.put(removal);
  EXPECT_EQ(tile().slots.size(), 9U);
}

TEST_F(DenseCloudTest, TheOnlyPointOfATileCanBeRemoved) {
  cloud_.put(records({0, 0}, 0, 1));
  map_points_t removal = records({0, 0}, 1, 1);
  removal.x[0] = -1 - 60;
  removal.y[0] = 0;
  cloud_.put(removal);
  EXPECT_TRUE(tile().slots.empty());
  EXPECT_TRUE(tile().by_voxel.empty());
}

TEST_F(DenseCloudTest, ShowsWhatComesAfterAGapAndTellsOfIt) {
  EXPECT_EQ(cloud_.put(records({0, 0}, 10, 10)), Put::kGap);
  EXPECT_EQ(tile().slots.size(), 10U);
  EXPECT_EQ(tile().version, 0);
  EXPECT_EQ(cloud_.put(records({0, 0}, 0, 20)), Put::kTaken);
  EXPECT_EQ(tile().slots.size(), 20U);
  EXPECT_EQ(tile().version, 20);
}

TEST_F(DenseCloudTest, KeepsWhatIsNearAndOfTheEpoch) {
  EXPECT_EQ(cloud_.put(records({20, 0}, 0, 1)), Put::kFar);
  EXPECT_EQ(cloud_.put(records({1, 0}, 0, 1, 2)), Put::kIgnored);
  cloud_.put(records({0, 0}, 0, 1));
  cloud_.put(records({9, 0}, 0, 1));
  EXPECT_EQ(cloud_.look(3, {{40, 0, DenseCloud::kReach}}), std::vector<TileKey>({{0, 0}}));
  EXPECT_EQ(cloud_.tiles().size(), 1U);
  cloud_.look(4, {{40, 0, DenseCloud::kReach}});
  EXPECT_TRUE(cloud_.tiles().empty());
}

TEST_F(DenseCloudTest, IsBoundedInATileAndInAll) {
  for (int first = 0; first < 5000; first += 1000) cloud_.put(records({0, 0}, first, 1000));
  EXPECT_EQ(tile().slots.size(), DenseCloud::kMaxTilePoints);
  cloud_.look(3, {{0, 0, 1000}});
  for (int x = -40; x < 40; ++x)
    for (int y = -40; y < 40; ++y) cloud_.put(records({x, y}, 0, 1));
  EXPECT_EQ(cloud_.tiles().size(), DenseCloud::kMaxTiles);
}

TEST_F(DenseCloudTest, HasTheSaliencesOfTheCoarseScale) {
  EXPECT_EQ(cloud_.put(voted({0, 0}, 0, 10, 0, 1)), Put::kTaken);
  ASSERT_EQ(tile().slots.size(), 10U);
  EXPECT_EQ(tile().slots[3].point.surface, 100);
  EXPECT_EQ(tile().slots[3].point.line, 30);
  // A tensor that changes changes its points; one that hardly changes does not.
  voted_points_t step = voted({0, 0}, 0, 10, 1, 2, 103, 30);
  cloud_.put(step);
  EXPECT_EQ(tile().slots[3].point.surface, 100);
  const auto number = tile().number;
  step = voted({0, 0}, 0, 10, 2, 3, 60, 90);
  cloud_.put(step);
  EXPECT_EQ(tile().slots[3].point.surface, 60);
  EXPECT_EQ(tile().slots[3].point.line, 90);
  EXPECT_EQ(tile().slots.size(), 10U);
  EXPECT_GT(tile().number, number);
}

TEST_F(DenseCloudTest, APointTakesTheTensorOfItsVoter) {
  voted_points_t message = voted({0, 0}, 0, 2, 0, 1);
  message.voter = {0, 0, 0, 0};
  message.stick = {0, 0, 77, 99};
  cloud_.put(message);
  EXPECT_EQ(tile().slots[1].point.surface, 77);
  message = voted({1, 0}, 0, 2, 0, 1);
  message.mass = {1, 1, 1, 0};
  cloud_.put(message);
  EXPECT_EQ(tile({1, 0}).slots[0].point.surface, 100);
  EXPECT_EQ(tile({1, 0}).slots[1].point.surface, 0) << "nobody voted";
}

TEST_F(DenseCloudTest, AWholeTileReplacesAndAGapIsToldOf) {
  EXPECT_EQ(cloud_.put(voted({0, 0}, 5, 5, 3, 4)), Put::kGap) << "what went before is missing";
  EXPECT_EQ(tile().slots.size(), 5U);
  EXPECT_EQ(cloud_.put(voted({0, 0}, 0, 10, 0, 4)), Put::kTaken);
  EXPECT_EQ(tile().slots.size(), 10U);
  EXPECT_EQ(tile().version, 4);
  EXPECT_EQ(cloud_.put(voted({0, 0}, 10, 2, 5, 6)), Put::kGap);
  EXPECT_EQ(cloud_.put(voted({0, 0}, 0, 3, 0, 7)), Put::kTaken);
  EXPECT_EQ(tile().slots.size(), 3U);
  voted_points_t other = voted({0, 0}, 0, 4, 0, 1);
  other.chain = 6;  // the worker began anew
  EXPECT_EQ(cloud_.put(other), Put::kTaken);
  EXPECT_EQ(tile().slots.size(), 4U);
  EXPECT_EQ(cloud_.put(records({0, 0}, 0, 20)), Put::kIgnored);
  EXPECT_EQ(tile().slots.size(), 4U);
}

TEST_F(DenseCloudTest, RefusesWhatIsNotSound) {
  const auto refuses = [&](auto message, auto mar) {
    mar(message);
    return cloud_.put(message) == Put::kRefused;
  };
  const map_points_t points = records({0, 0}, 0, 3);
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.x.pop_back(); }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.first = -1; }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.first = std::numeric_limits<std::int32_t>::max(); }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.x[1] = 1500; }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.x[1] = -1501; }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.y[1] = -1; }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.z_origin = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refuses(points, [](map_points_t& m) { m.num_points = -2; }));
  const voted_points_t step = voted({0, 0}, 0, 3, 0, 1);
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.voter[4] = 3; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.voter[4] = -1; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.point[4] = 3; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.x[2] = -4; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.first = 1; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.num_scales = 0; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.revision = 0; }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.mass.pop_back(); }));
  EXPECT_TRUE(refuses(step, [](voted_points_t& m) { m.sigma.pop_back(); }));
  EXPECT_TRUE(cloud_.tiles().empty());
}

}  // namespace
}  // namespace curbstone::viewer::store
