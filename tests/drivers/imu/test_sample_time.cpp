#include "drivers/imu/sample_time.hpp"

#include <gtest/gtest.h>

namespace curbstone::imu {
namespace {

TEST(SampleTimeTest, ATickIsATenthOfAMillisecond) {
  SampleTime time;
  EXPECT_EQ(time.unwrap(51'703'123).time, 5'170'312'300);
  EXPECT_EQ(time.unwrap(51'703'223).time, 5'170'322'300);
}

TEST(SampleTimeTest, UnwrapsAfterTwoToThe32) {
  SampleTime time;
  const std::int64_t before = time.unwrap(0xFFFFFFF0u).time;
  const auto after = time.unwrap(84);  // 100 ticks on
  EXPECT_FALSE(after.restarted);
  EXPECT_EQ(after.time - before, 10'000);
}

TEST(SampleTimeTest, UnwrapsAfterADay) {
  SampleTime time;
  const std::int64_t before = time.unwrap(863'999'950).time;
  const auto after = time.unwrap(50);
  EXPECT_FALSE(after.restarted);
  EXPECT_EQ(after.time - before, 10'000);
  EXPECT_EQ(time.unwrap(150).time - before, 20'000);
}

TEST(SampleTimeTest, PassesADayWithoutAWrapOnDevicesThatCountFurther) {
  SampleTime time;
  const std::int64_t before = time.unwrap(863'999'950).time;
  EXPECT_EQ(time.unwrap(864'000'050).time - before, 10'000);
}

TEST(SampleTimeTest, AnyOtherStepBackIsARestart) {
  SampleTime time;
  time.unwrap(1'000'000);
  const auto restarted = time.unwrap(20);
  EXPECT_TRUE(restarted.restarted);
  EXPECT_EQ(restarted.time, 2'000);
  EXPECT_FALSE(time.unwrap(120).restarted);
}

TEST(SampleTimeTest, AMessageThatWasSentLateIsNoRestart) {
  SampleTime time;
  time.unwrap(51'703'123);
  const auto fix = time.unwrap(51'702'704);  // a real GNSS message between inertial ones
  EXPECT_FALSE(fix.restarted);
  EXPECT_EQ(time.unwrap(51'703'223).time, 5'170'322'300);
}

TEST(PacketCounterTest, TellsLossesAcrossTheWrapAndNoneAfterARestart) {
  PacketCounter counter;
  EXPECT_EQ(counter.lost_before(65534), 0);
  EXPECT_EQ(counter.lost_before(65535), 0);
  EXPECT_EQ(counter.lost_before(0), 0);
  EXPECT_EQ(counter.lost_before(3), 2);
  counter.restart();
  EXPECT_EQ(counter.lost_before(0), 0);
  EXPECT_EQ(counter.lost_before(1), 0);
}

}  // namespace
}  // namespace curbstone::imu
