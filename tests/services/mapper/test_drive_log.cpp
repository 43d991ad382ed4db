#include "services/mapper/drive_log.hpp"

#include <gtest/gtest.h>

namespace curbstone::mapper {
namespace {

constexpr std::int64_t kPageBegin = 1'700'000'000'000'000;  // us; a page begins here

TrajectoryPoint pose(int i) {
  Pose T_map_base = Pose::Identity();
  T_map_base.translation().x() = 0.1 * i;
  return {kPageBegin + i * 50'000, i, T_map_base};
}

tile_request_t request_for(TileKey page, std::int32_t have, std::int32_t epoch = 3) {
  tile_request_t request{};
  request.channel = kDriveChannel;
  request.epoch = epoch;
  request.num_tiles = 1;
  request.tile_x = {page.x};
  request.tile_y = {page.y};
  request.have = {have};
  return request;
}

TEST(DriveLog, AnnouncesHowManyPosesEachTenSecondsHave) {
  DriveLog log;
  log.start_epoch(3, {});
  EXPECT_TRUE(log.make_index(kPageBegin).empty()) << "no drive yet";
  for (int i = 0; i < 250; ++i) log.add(pose(i));
  const auto index = log.make_index(kPageBegin);
  ASSERT_EQ(index.size(), 1U);
  EXPECT_EQ(index[0].channel, "MAP_TRAJECTORY");
  EXPECT_EQ(index[0].epoch, 3);
  ASSERT_EQ(index[0].num_tiles, 2);
  EXPECT_EQ(index[0].tile_x[0], drive_page(kPageBegin).x + 1) << "the newest first";
  EXPECT_EQ(index[0].version[0], 50);
  EXPECT_EQ(index[0].version[1], 200);
}

TEST(DriveLog, GivesAPageToWhoLacksPosesOfItAndToNobodyElse) {
  DriveLog log;
  log.start_epoch(3, {});
  for (int i = 0; i < 250; ++i) log.add(pose(i));
  log.request(request_for(drive_page(kPageBegin), 200));
  EXPECT_FALSE(log.take_requested()) << "it has all";
  log.request(request_for(drive_page(kPageBegin), 10, 2));
  EXPECT_FALSE(log.take_requested()) << "another epoch's";
  log.request(request_for(drive_page(kPageBegin), 199));
  const auto page = log.take_requested();
  ASSERT_TRUE(page);
  EXPECT_EQ(page->page, kPageAgain);
  EXPECT_EQ(page->epoch, 3);
  ASSERT_EQ(page->num_poses, 200);
  EXPECT_EQ(page->utimes[7], kPageBegin + 350'000);
  EXPECT_EQ(page->revolutions[7], 7);
  EXPECT_FLOAT_EQ(page->positions[7][0], 0.7F);
  EXPECT_FLOAT_EQ(page->orientations[7][0], 1.0F);
  EXPECT_FALSE(log.take_requested()) << "once for a request";
}

TEST(DriveLog, ANewEpochBeginsWithTheDriveAsItHasIt) {
  DriveLog log;
  log.start_epoch(3, {});
  for (int i = 0; i < 250; ++i) log.add(pose(i));
  log.start_epoch(4, {pose(0), pose(10)});
  log.add(pose(20));
  log.request(request_for(drive_page(kPageBegin), 0, 4));
  const auto page = log.take_requested();
  ASSERT_TRUE(page);
  EXPECT_EQ(page->num_poses, 3);
}

TEST(DriveLog, AMessageHasAnEndAndADriveOfDaysTakesNoMoreMemory) {
  DriveLog log;
  log.start_epoch(3, {});
  for (int i = 0; i < 2000; ++i) log.add({kPageBegin + i, i, Pose::Identity()});
  log.request(request_for(drive_page(kPageBegin), 0));
  EXPECT_LT(log.take_requested()->getEncodedSize(), 48'000);
  for (std::int64_t i = 0; i < 9000; ++i) log.add({kPageBegin + (i + 1) * kDrivePage, 0, Pose::Identity()});
  log.request(request_for(drive_page(kPageBegin), 0));
  EXPECT_FALSE(log.take_requested()) << "the oldest pages are forgotten";
}

}  // namespace
}  // namespace curbstone::mapper
