#include "services/viewer/foxglove/near_points.hpp"

#include <foxglove/packed.pb.h>
#include <gmock/gmock.h>

#include <limits>

namespace curbstone::viewer::foxglove {
namespace {

/// Records first, first + 1, ... of a tile: record k is a point at x step k.
map_points_t records(TileKey key, int first, int count, std::int32_t epoch = 3) {
  map_points_t message{};
  message.utime = 50;
  message.epoch = epoch;
  message.tile_x = key.x;
  message.tile_y = key.y;
  message.z_origin = 1;
  message.first = first;
  message.num_points = count;
  for (int k = first; k < first + count; ++k) {
    message.x.push_back(static_cast<std::int16_t>(k % kStepsPerTile));
    message.y.push_back(static_cast<std::int16_t>(k / kStepsPerTile));
    message.z.push_back(-250);
    message.intensity.push_back(9);
  }
  return message;
}

class NearPointsTest : public ::testing::Test {
 protected:
  NearPointsTest() { points_.look_from(3, 0, 0); }
  NearPoints points_;
};

TEST_F(NearPointsTest, LieWhereTheirTileIs) {
  EXPECT_TRUE(points_.put(records({-2, 1}, 5, 1)));
  const auto cloud = points_.points();
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_FLOAT_EQ(cloud[0].x, -5.99F);
  EXPECT_FLOAT_EQ(cloud[0].y, 3.0F);
  EXPECT_FLOAT_EQ(cloud[0].z, 0.5F);
  EXPECT_FLOAT_EQ(cloud[0].intensity, 9);
}

TEST_F(NearPointsTest, TakeRepeatedRecordsOnceAndRemovalsOut) {
  points_.put(records({0, 0}, 0, 10));
  points_.put(records({0, 0}, 0, 10));
  points_.put(records({0, 0}, 5, 10));
  EXPECT_EQ(points_.points().size(), 15U);
  map_points_t removal = records({0, 0}, 15, 1);
  removal.x[0] = -1 - 3;
  removal.y[0] = 0;
  points_.put(removal);
  EXPECT_EQ(points_.points().size(), 14U);
  points_.put(removal);
  EXPECT_EQ(points_.points().size(), 14U);
}

TEST_F(NearPointsTest, ForgetWhatLiesBehindAndOtherEpochs) {
  points_.put(records({0, 0}, 0, 10));
  points_.put(records({4, 0}, 0, 7));
  points_.put(records({1, 0}, 0, 10, 2));
  EXPECT_EQ(points_.points().size(), 17U);
  points_.look_from(3, 40, 0);
  EXPECT_EQ(points_.points().size(), 7U);
  points_.look_from(4, 40, 0);
  EXPECT_TRUE(points_.points().empty());
}

TEST_F(NearPointsTest, AreBoundedInATileInAllAndInAMessage) {
  for (int first = 0; first < 20'000; first += 1000) points_.put(records({0, 0}, first, 1000));
  EXPECT_EQ(points_.points().size(), NearPoints::kMaxTilePoints);
  for (int x = -40; x < 40; ++x)
    for (int y = -40; y < 40; ++y) points_.put(records({x, y}, 0, 3000));
  EXPECT_LE(points_.points().size(), NearPoints::kMaxMessagePoints);
  EXPECT_GT(points_.points().size(), NearPoints::kMaxMessagePoints / 2);
}

TEST_F(NearPointsTest, RefuseWhatIsNotSound) {
  map_points_t message = records({0, 0}, 0, 3);
  message.z.pop_back();
  EXPECT_FALSE(points_.put(message));
  message = records({0, 0}, 0, 3);
  message.first = -1;
  EXPECT_FALSE(points_.put(message));
  message = records({0, 0}, 0, 3);
  message.z_origin = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(points_.put(message));
  EXPECT_TRUE(points_.points().empty());
}

TEST(PointMessageTest, HasFourFloatsAPoint) {
  ::foxglove::PointCloud cloud;
  ASSERT_TRUE(cloud.ParseFromString(point_message({{1, 2, 3, 4}, {5, 6, 7, 8}}, "map", 1'000'001)));
  EXPECT_EQ(cloud.point_stride(), 16U);
  EXPECT_EQ(cloud.fields_size(), 4);
  EXPECT_EQ(cloud.fields(3).name(), "intensity");
  EXPECT_EQ(cloud.fields(3).offset(), 12U);
  EXPECT_EQ(cloud.fields(3).type(), ::foxglove::PackedElementField::FLOAT32);
  EXPECT_EQ(cloud.data().size(), 32U);
  EXPECT_EQ(cloud.data().substr(0, 4), std::string("\0\0\x80\x3f", 4));
  EXPECT_EQ(cloud.timestamp().nanos(), 1000);
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
