#include <gtest/gtest.h>

#include <map>

#include "drivers/lidar/decoding/head_tracker.hpp"

namespace curbstone::lidar::decoding {
namespace {

/// A head at 20 Hz: a packet is 959.04 (0.01 deg) wide; here 959, and the azimuths are rounded as the device's are.
struct Head {
  static constexpr double kRate = 7200 * 100;
  static constexpr double kDuration = 1332e-6;
  static HeadTracker::Packet packet(int index) {
    const double azimuth = index * kRate * kDuration;
    return {1'000'000 + index * 1332LL, static_cast<int>(azimuth) % 36000, kRate, kDuration};
  }
};

TEST(HeadTracker, CountsARevolutionWhenTheCutAngleIsPassed) {
  HeadTracker tracker(18000);
  std::int32_t last = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto step = tracker.follow(Head::packet(i));
    EXPECT_EQ(step.lost, 0);
    const std::int64_t absolute = static_cast<std::int64_t>(i * Head::kRate * Head::kDuration);
    EXPECT_EQ(step.revolution, (absolute + 18000) / 36000) << i;
    last = step.revolution;
  }
  EXPECT_EQ(last, 80);
}

TEST(HeadTracker, SeesHowManyPacketsWereLost) {
  for (const int gap : {1, 2, 7, 36, 37, 38, 100, 700}) {
    HeadTracker tracker(0);
    for (int i = 0; i < 10; ++i) tracker.follow(Head::packet(i));
    const auto step = tracker.follow(Head::packet(10 + gap));
    EXPECT_EQ(step.lost, gap);
    EXPECT_EQ(step.revolution, static_cast<int>((10 + gap) * Head::kRate * Head::kDuration) / 36000);
  }
}

TEST(HeadTracker, CountsLossesWithTimesOfReceiptToo) {
  HeadTracker tracker(0);
  std::int64_t lost = 0;
  for (int i = 0; i < 1000; ++i) {
    if (i % 100 == 50) continue;
    HeadTracker::Packet packet = Head::packet(i);
    packet.utime += (i * 7919) % 5000;  // up to 5 ms late
    lost += tracker.follow(packet).lost;
  }
  EXPECT_EQ(lost, 10);
}

TEST(HeadTracker, DoesNotFollowAPacketThatCameTwiceOrLate) {
  HeadTracker tracker(0);
  tracker.follow(Head::packet(0));
  tracker.follow(Head::packet(2));
  EXPECT_TRUE(tracker.follow(Head::packet(2)).duplicate);
  EXPECT_TRUE(tracker.follow(Head::packet(1)).late);
  const auto step = tracker.follow(Head::packet(3));
  EXPECT_FALSE(step.late || step.duplicate);
  EXPECT_EQ(step.lost, 0);
}

TEST(HeadTracker, DoesNotCountAFieldOfViewAsLoss) {
  HeadTracker tracker(0);
  HeadTracker::Packet packet = Head::packet(0);
  tracker.follow(packet, 18000);
  packet.azimuth += 18000 + 959;  // half a turn blind, behind the packet
  packet.utime += 1332 + 25'000;
  EXPECT_EQ(tracker.follow(packet, 18000).lost, 0);
}

TEST(HeadTracker, NeverCountsScansDown) {
  HeadTracker tracker(0);
  tracker.follow({0, 1, 0, 1e-3});
  EXPECT_EQ(tracker.follow({1000, 0, 0, 1e-3}).revolution, 0);
  EXPECT_EQ(tracker.follow({2000, 35999, 0, 1e-3}).revolution, 0);
  EXPECT_EQ(tracker.follow({3000, 0, 0, 1e-3}).revolution, 0);
}

TEST(HeadTracker, SaysNothingOfWhatWasLostWhenTheClockWasSet) {
  HeadTracker tracker(0);
  for (int i = 0; i < 5; ++i) tracker.follow(Head::packet(i));
  HeadTracker::Packet packet = Head::packet(5);
  packet.utime += 3'600'000'000;
  EXPECT_EQ(tracker.follow(packet).lost, 0);
  EXPECT_EQ(tracker.follow(Head::packet(6)).lost, 0);
  EXPECT_FALSE(tracker.follow(Head::packet(7)).late);
}

}  // namespace
}  // namespace curbstone::lidar::decoding
