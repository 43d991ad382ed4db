#include "services/ekf/inputs/running_clock.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <tuple>

#include "tests/stamps.hpp"

namespace curbstone::ekf::inputs {
namespace {

using test::kStart;
using Sensor = RunningClock::Sensor;

constexpr std::int64_t kPeriod = 10'000;
constexpr std::int64_t kFar = 3'600'000'000;

class RunningClockTest : public ::testing::Test {
 protected:
  /// Both sensors for `seconds`, with stamps of a clock that is `set_by` off.
  void drive(double seconds, std::int64_t imu_set_by, std::int64_t wheels_set_by) {
    for (const int end = i_ + static_cast<int>(seconds * 100); i_ < end; ++i_) {
      add(Sensor::kWheels, i_ * kPeriod + 4'000, wheels_set_by);
      add(Sensor::kImu, i_ * kPeriod, imu_set_by);
    }
  }
  void add(Sensor sensor, std::int64_t at, std::int64_t set_by) {
    const auto utime = clock_.add(sensor, kStart + at + set_by, i_);
    if (!utime) ++dropped_;
    const bool ahead = sensor == Sensor::kWheels && set_by > clock_.offset() + 1'000;  // the node lets them go
    if (ahead) {
      ++ahead_;
    } else if (utime) {
      EXPECT_NEAR(static_cast<double>(*utime), static_cast<double>(kStart + at), 1'000) << i_;
    }
  }

  RunningClock clock_;
  int i_ = 0;
  int dropped_ = 0;
  int ahead_ = 0;
};

TEST_F(RunningClockTest, LeavesWhatRunsOnAsItIs) {
  drive(5, 0, 0);
  i_ += 70;  // both were silent, or lost
  drive(5, 0, 0);
  EXPECT_EQ(dropped_, 0);
  EXPECT_EQ(clock_.offset(), 0);
}

TEST_F(RunningClockTest, TakesOutStepsBackAndForthWhicheverSensorIsSetFirst) {
  std::int64_t set = 0;
  for (const std::int64_t step : std::initializer_list<std::int64_t>{-500'000, 900'000, 150'000, -990'000, 500'000,
                                                                     -2'000'000, kFar, 5'000'000, -kFar, -120'000}) {
    drive(3, set, set);
    if (step < 0) {
      drive(0.02, set, set + step);
    } else {
      drive(0.02, set + step, set);
    }
    set += step;
    drive(3, set, set);
    EXPECT_NEAR(static_cast<double>(clock_.offset()), static_cast<double>(set), 10) << step;
  }
  EXPECT_EQ(clock_.counters().values().at("clock_set.imu"), 10);
  EXPECT_EQ(clock_.counters().values().at("clock_set.wheels"), 5) << "forward they go with the IMU";
  EXPECT_LE(dropped_, 40);
  EXPECT_LE(ahead_, 5);
}

/// Their numbers are those of messages.
TEST_F(RunningClockTest, WheelsThatWereSilentAreNotSetForward) {
  for (int i = 0; i < 600; ++i) {
    const bool silent = i >= 300 && i < 370;
    EXPECT_EQ(clock_.add(Sensor::kImu, kStart + i * kPeriod, i), kStart + i * kPeriod);
    if (silent) continue;
    EXPECT_EQ(clock_.add(Sensor::kWheels, kStart + i * kPeriod, i < 300 ? i : i - 70), kStart + i * kPeriod);
  }
}

/// A cable that is out for half a second, and a driver that goes on counting.
TEST_F(RunningClockTest, AnImuThatWasSilentIsNotSetForward) {
  for (const int silent_until : {315, 350, 390}) {
    RunningClock clock;
    int dropped = 0;
    for (int i = 0; i < 600; ++i) {
      EXPECT_EQ(clock.add(Sensor::kWheels, kStart + i * kPeriod - 4'000, i), kStart + i * kPeriod - 4'000);
      if (i >= 300 && i < silent_until) continue;
      const auto out = clock.add(Sensor::kImu, kStart + i * kPeriod, i < 300 ? i : i - silent_until + 300);
      dropped += out ? 0 : 1;
      EXPECT_EQ(out.value_or(kStart + i * kPeriod), kStart + i * kPeriod);
    }
    EXPECT_LE(dropped, 11);
    EXPECT_EQ(clock.offset(), 0);
    EXPECT_FALSE(clock.counters().values().contains("clock_set.imu"));
  }
}

/// As a WitMotion that nobody has set up does.
TEST_F(RunningClockTest, SlowSensorsAreTakenAsTheyAre) {
  for (const std::int64_t period : {100'000, 200'000}) {
    RunningClock clock;
    for (int i = 0; i < 300; ++i) {
      const std::int64_t utime = kStart + i * period + i % 7 * 5'000;
      EXPECT_EQ(clock.add(Sensor::kImu, utime, i), utime);
      EXPECT_EQ(clock.add(Sensor::kWheels, utime + 3'000, i), utime + 3'000);
    }
  }
}

/// Nobody says that it was the clock.
TEST_F(RunningClockTest, AnImuAloneIsNotSetForward) {
  for (int i = 0; i < 600; ++i) {
    const std::int64_t utime = kStart + i * kPeriod + (i < 300 ? 0 : 500'000);
    const auto out = clock_.add(Sensor::kImu, utime, i);
    EXPECT_EQ(out.value_or(utime), utime);
    EXPECT_EQ(out.has_value(), i < 300 || i > 310) << i;
  }
}

/// One wild stamp, a message that was overtaken, a block that was, and a driver that began again.
TEST_F(RunningClockTest, IsNotFooled) {
  for (int i = 0; i < 2000; ++i) {
    std::int64_t utime = kStart + i * kPeriod;
    if (i == 200 || i == 201) utime += i == 200 ? -700'000 : 700'000;
    const auto out = clock_.add(Sensor::kImu, utime, i);
    if (i != 200 && i != 201) {
      ASSERT_EQ(out, utime) << i;
    }
    if (i == 400) std::ignore = clock_.add(Sensor::kImu, kStart + 350 * kPeriod, 350);
    if (i != 600) continue;
    for (int late = 540; late < 560; ++late)
      EXPECT_EQ(clock_.add(Sensor::kImu, kStart + late * kPeriod, late), kStart + late * kPeriod);
  }
  for (int i = 0; i < 500; ++i) {
    const std::int64_t utime = kStart + (2060 + i) * kPeriod;
    ASSERT_EQ(clock_.add(Sensor::kImu, utime, i), utime);
  }
  EXPECT_EQ(clock_.offset(), 0);
}

/// Both on one hub, whose plug was loose while the vehicle drove on.
TEST_F(RunningClockTest, SensorsThatWereBothSilentAreNotSetForward) {
  for (const std::int64_t silence : {300'000, 3'000'000, 60'000'000}) {
    RunningClock clock;
    for (int i = 0; i < 600; ++i) {
      const std::int64_t utime = kStart + i * kPeriod + (i < 300 ? 0 : silence);
      const double angle = 1e-5 * static_cast<double>(utime - kStart);  // rad
      EXPECT_EQ(clock.add(Sensor::kWheels, utime, i, {angle, angle}), utime);
      EXPECT_EQ(clock.add(Sensor::kImu, utime + 1'000, i).value_or(utime + 1'000), utime + 1'000);
    }
    EXPECT_EQ(clock.offset(), 0);
  }
}

/// The LiDAR's stamps are those of the sensor that was not set.
TEST_F(RunningClockTest, WhereOneSensorsClockAloneIsSetToAndFroTheOutputStaysOnTheOther) {
  for (const bool imu : {true, false}) {
    RunningClock clock;
    for (int i = 0; i < 900; ++i) {
      const std::int64_t utime = kStart + i * kPeriod;
      const std::int64_t set = i / 300 == 1 ? -2'000'000 : 0;
      EXPECT_EQ(clock.add(Sensor::kWheels, utime + (imu ? 0 : set), i).value_or(utime), utime) << i;
      EXPECT_EQ(clock.add(Sensor::kImu, utime + (imu ? set : 0), i).value_or(utime), utime) << i;
      EXPECT_EQ(clock.offset(), 0) << i;
    }
  }
}

TEST_F(RunningClockTest, OneStampOfTheWheelsThatIsWildIsNoClock) {
  for (const std::int64_t wild : std::initializer_list<std::int64_t>{700'000, 2'000'000, kFar, -kFar}) {
    RunningClock clock;
    for (int i = 0; i < 600; ++i) {
      const std::int64_t utime = kStart + i * kPeriod;
      const auto out = clock.add(Sensor::kWheels, utime + (i == 300 ? wild : 0), i);
      if (i != 300) {
        ASSERT_EQ(out, utime) << i;
      }
      EXPECT_EQ(clock.add(Sensor::kImu, utime, i), utime);
    }
  }
}

}  // namespace
}  // namespace curbstone::ekf::inputs
