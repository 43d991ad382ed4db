#include "drivers/imu/xsens/packet_counter.hpp"

#include <gtest/gtest.h>

namespace curbstone::imu::xsens {
namespace {

TEST(PacketCounterTest, TellsLossesAcrossTheWrapAndNoneAfterARestart) {
  PacketCounter counter;
  EXPECT_FALSE(counter.gap(65534));
  counter.used(65534);
  EXPECT_EQ(counter.gap(65535)->lost, 0);
  counter.used(65535);
  EXPECT_EQ(counter.gap(2)->lost, 2);
  counter.used(2);
  counter.restart();
  EXPECT_FALSE(counter.gap(100));
}

TEST(PacketCounterTest, MessagesThatCameBetweenTwoSamplesAreNoLosses) {
  PacketCounter counter;
  counter.used(65534);
  counter.other(65535);
  EXPECT_EQ(counter.gap(0)->lost, 0);
  EXPECT_EQ(counter.gap(1)->lost, 1) << "a sample was lost beside it";
}

TEST(PacketCounterTest, MessagesWithNumbersOfAnotherRowHideNoLoss) {
  PacketCounter counter;
  counter.used(1000);
  counter.other(7);
  counter.other(1000);
  EXPECT_EQ(counter.gap(1002)->lost, 1);
}

TEST(PacketCounterTest, SamplesThatCameAndWereRefusedAreAheadAndNotLost) {
  PacketCounter counter;
  counter.used(10);
  counter.refused(11);
  EXPECT_EQ(counter.gap(12)->ahead, 2);
  EXPECT_EQ(counter.gap(12)->lost, 0);
  EXPECT_EQ(counter.gap(13)->lost, 1);
}

TEST(PacketCounterTest, WhatComesLateWasNotLost) {
  PacketCounter counter;
  counter.used(65534);
  EXPECT_EQ(counter.gap(1)->lost, 2);
  counter.used(1);
  EXPECT_EQ(counter.gap(0)->ahead, -1);
  EXPECT_TRUE(counter.found(0));
  EXPECT_FALSE(counter.found(0)) << "a second time";
  EXPECT_TRUE(counter.found(65535));
  EXPECT_FALSE(counter.found(65534)) << "it was used";
}

TEST(PacketCounterTest, AnyNumberOfOthersIsBorne) {
  PacketCounter counter;
  counter.used(0);
  for (std::uint16_t i = 1; i < 1000; ++i) counter.other(i);
  EXPECT_GE(counter.gap(1000)->lost, 0);
}

}  // namespace
}  // namespace curbstone::imu::xsens
