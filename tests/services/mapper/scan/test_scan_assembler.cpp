#include "services/mapper/scan/scan_assembler.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

using test::kStart;

/// Packet `number` of a stream of 10 packets a revolution, 5 ms a packet, with `points` returns.
lidar_points_t packet_of(std::int32_t number, int points = 4) {
  lidar_points_t m;
  m.utime = kStart + 5000 * static_cast<std::int64_t>(number);
  m.packet = number;
  m.revolution = number / 10;
  for (int i = 0; i < points; ++i) {
    m.x.push_back(5.0F);
    m.y.push_back(static_cast<float>(i));
    m.z.push_back(0.0F);
    m.time_offset.push_back(0.001F * static_cast<float>(i));
    m.intensity.push_back(1);
    m.ring.push_back(static_cast<std::uint8_t>(i));
  }
  m.num_points = points;
  return m;
}

TEST(ScanAssembler, GivesAScanWhenTheNextBegins) {
  ScanAssembler assembler;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(assembler.add(packet_of(i)));
  const auto revolution = assembler.add(packet_of(10));
  ASSERT_TRUE(revolution);
  EXPECT_EQ(revolution->number, 0);
  EXPECT_EQ(revolution->packets, 10);
  EXPECT_EQ(revolution->points.size(), 40u);
  EXPECT_EQ(revolution->start, kStart);
  EXPECT_EQ(revolution->end, kStart + 9 * 5000 + 3000);
  EXPECT_NEAR(revolution->points.back().time, 0.048F, 1e-6F);
}

TEST(ScanAssembler, RevolutionsWithOneStampAreTold) {
  ScanAssembler assembler;
  for (int i = 0; i < 600; ++i) {
    lidar_points_t packet = packet_of(i, 1);
    if (i < 300) packet.utime = packet_of(i / 10 * 10).utime;
    (void)assembler.add(packet);
    if (i == 190 || i == 290) {
      EXPECT_EQ(assembler.has_one_stamp(), i == 290) << i;
    }
  }
  EXPECT_FALSE(assembler.has_one_stamp()) << "of a driver that was mended";
  EXPECT_EQ(assembler.counters()["lidar.one_stamp"], 30);
}

TEST(ScanAssembler, StampsOfTheRevolutionsBeginWithTimesOfThePointsAreGood) {
  ScanAssembler assembler;
  for (int i = 0; i < 600; ++i) {
    lidar_points_t packet = packet_of(i);
    const std::int64_t start = packet_of(i / 10 * 10).utime;
    for (float& offset : packet.time_offset) offset += 1e-6F * static_cast<float>(packet.utime - start);
    packet.utime = start;
    (void)assembler.add(packet);
  }
  EXPECT_EQ(assembler.counters()["lidar.one_stamp"], 0);
}

TEST(ScanAssembler, CountsWhatWasLost) {
  ScanAssembler assembler;
  for (const int i : {0, 1, 4, 5, 9}) (void)assembler.add(packet_of(i));
  const auto revolution = assembler.flush();
  ASSERT_TRUE(revolution);
  EXPECT_EQ(revolution->lost, 5);
  EXPECT_EQ(assembler.counters()["lidar.lost"], 5);
}

TEST(ScanAssembler, CountsWithNumbersAsFarApartAsTheyCanBe) {
  ScanAssembler assembler;
  lidar_points_t message = packet_of(0);
  message.packet = std::numeric_limits<std::int32_t>::min();
  (void)assembler.add(message);
  message.utime += 1000;
  message.packet = std::numeric_limits<std::int32_t>::max();
  (void)assembler.add(message);
  EXPECT_EQ(assembler.counters()["lidar.lost"], 4'294'967'294);
}

TEST(ScanAssembler, TakesALatePacketOfTheRunningScanAndNoDuplicate) {
  ScanAssembler assembler;
  for (const int i : {0, 2, 1, 1, 2, 3}) (void)assembler.add(packet_of(i));
  const auto revolution = assembler.flush();
  EXPECT_EQ(revolution->packets, 4);
  EXPECT_EQ(revolution->lost, 0);
  EXPECT_EQ(assembler.counters()["lidar.reordered"], 1);
  EXPECT_EQ(assembler.counters()["dropped.duplicate"], 2);
}

TEST(ScanAssembler, DropsWhatBelongsToAnOlderScan) {
  ScanAssembler assembler;
  for (const int i : {8, 10, 11}) (void)assembler.add(packet_of(i));
  EXPECT_FALSE(assembler.add(packet_of(9)));
  EXPECT_EQ(assembler.counters()["dropped.late"], 1);
  EXPECT_EQ(assembler.flush()->packets, 2);
}

TEST(ScanAssembler, BeginsAgainWhenTheClockJumps) {
  ScanAssembler assembler;
  (void)assembler.add(packet_of(0));
  lidar_points_t jumped = packet_of(1);
  jumped.utime -= 3600LL * 1'000'000;
  ASSERT_TRUE(assembler.add(jumped));
  EXPECT_EQ(assembler.counters()["lidar.clock_jumps"], 1);
  EXPECT_EQ(assembler.flush()->start, jumped.utime);
}

TEST(ScanAssembler, BeginsAgainWhenTheDriverDoes) {
  ScanAssembler assembler;
  (void)assembler.add(packet_of(57));
  lidar_points_t again = packet_of(0);
  again.utime = packet_of(80).utime;
  ASSERT_TRUE(assembler.add(again));
  EXPECT_EQ(assembler.counters()["lidar.restarts"], 1);
}

TEST(ScanAssembler, LeavesOutWhatIsNoPoint) {
  ScanAssembler assembler;
  lidar_points_t m = packet_of(0, 6);
  m.x[0] = std::numeric_limits<float>::quiet_NaN();
  m.y[1] = std::numeric_limits<float>::infinity();
  m.x[2] = m.y[2] = m.z[2] = 0;
  m.time_offset[3] = -1;
  m.x[4] = 1e30F;
  (void)assembler.add(m);
  EXPECT_EQ(assembler.flush()->points.size(), 1u);
  EXPECT_EQ(assembler.counters()["refused.not_finite"], 4);  // 1e30 squared is not finite either
  EXPECT_EQ(assembler.counters()["points.out_of_range"], 1);
}

TEST(ScanAssembler, RefusesAMessageWhoseArraysDisagree) {
  ScanAssembler assembler;
  lidar_points_t m = packet_of(0);
  m.ring.pop_back();
  EXPECT_FALSE(assembler.add(m));
  EXPECT_FALSE(assembler.flush());
  EXPECT_EQ(assembler.counters()["refused.packet"], 1);
}

TEST(ScanAssembler, CutsAScanThatNeverEnds) {
  ScanAssembler assembler;
  std::size_t largest = 0;
  for (int i = 0; i < 1000; ++i) {
    lidar_points_t m = packet_of(i);
    m.revolution = 0;
    if (const auto revolution = assembler.add(m)) largest = std::max(largest, revolution->points.size());
  }
  EXPECT_GT(largest, 0u);
  EXPECT_LE(largest, 4u * 82);
  EXPECT_GT(assembler.counters()["refused.endless_scan"], 5);
}

TEST(ScanAssembler, TakesAScanOf32LasersWithTwoReturnsAt5HzWhole) {
  ScanAssembler assembler;
  for (int i = 0; i < 600; ++i) {
    lidar_points_t packet = packet_of(i, 384);
    packet.utime = kStart + 333 * static_cast<std::int64_t>(i);
    packet.revolution = 0;
    packet.time_offset.assign(384, 0.0F);
    EXPECT_FALSE(assembler.add(packet));
  }
  const auto scan = assembler.flush();
  ASSERT_TRUE(scan);
  EXPECT_GT(scan->points.size() + static_cast<std::size_t>(assembler.counters()["points.out_of_range"]), 230'000u);
  EXPECT_EQ(assembler.counters()["refused.endless_scan"], 0);
}

}  // namespace
}  // namespace curbstone::mapper::scan
