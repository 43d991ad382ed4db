#include "services/mapper/detection/lidar_silence.hpp"

#include <gmock/gmock.h>

namespace curbstone::mapper::detection {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> faults_of(const LidarSilence& silence) {
  std::vector<std::string> faults;
  silence.add_faults(faults);
  return faults;
}

TEST(LidarSilence, IsNamedAfterASecondUntilPacketsCome) {
  LidarSilence silence;
  std::int64_t now = 1'700'000'000'000'000;
  for (int i = 0; i < 90; ++i) silence.tick(now += 20'000);
  EXPECT_THAT(faults_of(silence), IsEmpty()) << "its driver may be starting as well";
  for (int i = 0; i < 15; ++i) silence.tick(now += 20'000);
  EXPECT_THAT(faults_of(silence), ElementsAre("no LIDAR_POINTS"));
  silence.heard();
  for (int i = 0; i < 50; ++i) silence.tick(now += 20'000);
  EXPECT_THAT(faults_of(silence), IsEmpty());
  for (int i = 0; i < 15; ++i) silence.tick(now += 20'000);
  ASSERT_EQ(faults_of(silence).size(), 1U);
  EXPECT_THAT(faults_of(silence)[0], HasSubstr("LiDAR: silent for 1.3 s"));
  silence.heard();
  EXPECT_THAT(faults_of(silence), IsEmpty());
}

TEST(LidarSilence, AProcessThatWasStoppedAndAClockThatJumpsAreNotTheLidars) {
  LidarSilence silence;
  silence.tick(1'700'000'000'000'000);
  silence.heard();
  silence.tick(1'700'003'600'000'000);
  silence.tick(1'700'000'000'000'000);
  EXPECT_THAT(faults_of(silence), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::detection
