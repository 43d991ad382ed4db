#include <gmock/gmock.h>

#include <cmath>

#include "tests/tools/bench/sensor_faults/catalogue/fault_helpers.hpp"

namespace curbstone::bench::sensor_faults::catalogue {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

auto near_all(double x, double y, double z) {
  return ElementsAre(DoubleNear(x, 1e-9), DoubleNear(y, 1e-9), DoubleNear(z, 1e-9));
}

imu_t one(const char* name) {
  return after(fault_named(name), some_imu()).at(0);
}

TEST(ImuFaults, UnitsMultiply) {
  const imu_t degrees = one("gyro in deg/s");
  EXPECT_NEAR(degrees.angular_rate[2], 0.3 * 57.29578, 1e-4);
  EXPECT_EQ(degrees.acceleration[2], 3);
  const imu_t g = one("acceleration in g");
  EXPECT_NEAR(g.acceleration[2], 3 / 9.80665, 1e-12);
  EXPECT_EQ(g.angular_rate[2], some_imu().angular_rate[2]);
}

TEST(ImuFaults, AxesAreOtherAxes) {
  EXPECT_THAT(one("IMU turned 90 deg").acceleration, near_all(2, -1, 3));
  EXPECT_THAT(one("IMU turned 90 deg").angular_rate, near_all(0.2, -0.1, 0.3));
  EXPECT_THAT(one("IMU x, y swapped").acceleration, near_all(2, 1, 3));
  EXPECT_THAT(one("IMU upside down").acceleration, near_all(1, -2, -3));
  EXPECT_THAT(one("IMU on its side").acceleration, near_all(1, -3, 2));
  EXPECT_THAT(one("yaw rate of wrong sign").angular_rate, near_all(0.1, 0.2, -0.3));
  const imu_t turned = one("IMU turned 10 deg");
  EXPECT_NEAR(std::hypot(turned.acceleration[0], turned.acceleration[1]), std::hypot(1, 2), 1e-12);
  EXPECT_EQ(turned.acceleration[2], 3);
}

TEST(ImuFaults, AGyroFailsAndTheAccelerationStays) {
  for (const char* name : {"yaw rate 0", "gyro 0", "gyro clips", "gyro leaps", "gyro leaps far", "gyro 5 % fast"}) {
    const imu_t m = one(name);
    EXPECT_THAT(m.acceleration, near_all(1, 2, 3)) << name;
    EXPECT_NE(m.angular_rate[2], some_imu().angular_rate[2]) << name;
  }
  EXPECT_THAT(one("yaw rate 0").angular_rate, near_all(0.1, 0.2, 0));
  EXPECT_THAT(one("gyro 0").angular_rate, near_all(0, 0, 0));
  EXPECT_THAT(one("gyro clips").angular_rate, near_all(0.1, 0.2, 0.1));
  EXPECT_NEAR(after(fault_named("gyro warms up"), some_imu(), 35).at(0).angular_rate[2], 0.31, 1e-9);
}

TEST(ImuFaults, FrozenValuesAreThoseOfTheFirstMessage) {
  const Changes gyro = fault_named("gyro frozen").make(), all = fault_named("IMU frozen").make();
  imu_t first = some_imu(), first_of_all = some_imu();
  gyro.imu(15, first);
  all.imu(15, first_of_all);
  imu_t m = some_imu();
  m.angular_rate[2] = 9, m.acceleration[0] = 9;
  imu_t n = m;
  gyro.imu(15.1, m);
  all.imu(15.1, n);
  EXPECT_THAT(m.angular_rate, near_all(0.1, 0.2, 0.3));
  EXPECT_EQ(m.acceleration[0], 9);
  EXPECT_THAT(n.acceleration, near_all(1, 2, 3));
  EXPECT_THAT(n.angular_rate, near_all(0.1, 0.2, 0.3));
}

TEST(ImuFaults, EverySampleTwice) {
  const Changes twice = fault_named("every sample twice").make();
  std::vector<double> x;
  for (int i = 0; i < 6; ++i) {
    imu_t m = some_imu();
    m.acceleration[0] = i;
    twice.imu(0, m);
    x.push_back(m.acceleration[0]);
  }
  EXPECT_THAT(x, ElementsAre(0, 0, 2, 2, 4, 4));
}

TEST(ImuFaults, SomeValuesAreNanOrSpikes) {
  const Changes nan = fault_named("IMU NaN").make(), spikes = fault_named("IMU spikes").make();
  int is_nan = 0, is_spike = 0;
  for (int i = 0; i < 1000; ++i) {
    imu_t m = some_imu(), n = some_imu();
    nan.imu(20, m);
    spikes.imu(20, n);
    double sum = 0, off = 0;
    for (int axis = 0; axis < 3; ++axis) {
      sum += m.acceleration[axis] + m.angular_rate[axis];
      off += std::abs(n.acceleration[axis] - (axis + 1)) + std::abs(n.angular_rate[axis] - 0.1 * (axis + 1));
    }
    is_nan += std::isnan(sum) ? 1 : 0;
    is_spike += off > 5 ? 1 : 0;
  }
  EXPECT_NEAR(is_nan, 50, 20);
  EXPECT_NEAR(is_spike, 20, 15);
}

TEST(ImuFaults, StampsRatesAndSilence) {
  EXPECT_EQ(one("IMU stamps late").utime, 1'040'000);
  EXPECT_EQ(after(fault_named("IMU clock set back"), some_imu(5'000'000)).at(0).utime, 3'000'000);
  EXPECT_TRUE(after(fault_named("IMU silent"), some_imu()).empty());
  EXPECT_TRUE(after(fault_named("IMU and wheels silent"), some_imu()).empty());
  EXPECT_TRUE(after(fault_named("IMU and wheels silent"), some_wheels()).empty());
}

}  // namespace
}  // namespace curbstone::bench::sensor_faults::catalogue
