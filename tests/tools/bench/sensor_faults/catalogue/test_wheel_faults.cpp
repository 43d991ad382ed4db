#include <gmock/gmock.h>

#include <cmath>

#include "tests/tools/bench/sensor_faults/catalogue/fault_helpers.hpp"

namespace curbstone::bench::sensor_faults::catalogue {
namespace {

TEST(WheelFaults, LeftBackwardsNegatesOnlyTheLeftWheel) {
  const wheels_t m = after(fault_named("left backwards"), some_wheels()).at(0);
  EXPECT_EQ(m.counts[0], -4096);
  EXPECT_EQ(m.angle[0], -6.25);
  EXPECT_EQ(m.speed[0], -10);
  EXPECT_EQ(m.counts[1], 8192);
  EXPECT_EQ(m.angle[1], 12.5);
  EXPECT_EQ(m.speed[1], 20);
}

TEST(WheelFaults, BothBackwardsAndSwapped) {
  const wheels_t backwards = after(fault_named("both backwards"), some_wheels()).at(0);
  EXPECT_EQ(backwards.angle[0], -6.25);
  EXPECT_EQ(backwards.angle[1], -12.5);
  const wheels_t swapped = after(fault_named("wheels swapped"), some_wheels()).at(0);
  EXPECT_EQ(swapped.counts[0], 8192);
  EXPECT_EQ(swapped.angle[1], 6.25);
  EXPECT_EQ(swapped.speed[0], 20);
}

TEST(WheelFaults, CountsPerRevolutionChangeTheAnglesAndNotTheCounts) {
  const wheels_t twice = after(fault_named("counts / revolution x 1/2"), some_wheels()).at(0);
  EXPECT_EQ(twice.counts[1], 8192);
  EXPECT_EQ(twice.angle[1], 25);
  EXPECT_EQ(twice.speed[0], 20);
  EXPECT_EQ(after(fault_named("counts / revolution x 2"), some_wheels()).at(0).angle[0], 3.125);
}

TEST(WheelFaults, AFlatTyreTurnsTheLeftWheelFasterFromThenOn) {
  const Changes flat = fault_named("flat tyre").make();
  wheels_t m = some_wheels();
  flat.wheels(15, m);
  EXPECT_EQ(m.counts[0], 4096) << "what it has turned before stays";
  m = some_wheels();
  m.counts[0] += 950, m.angle[0] += 0.95, m.angle[1] += 1;
  flat.wheels(15.1, m);
  EXPECT_EQ(m.counts[0], 4096 + 1000);
  EXPECT_NEAR(m.angle[0], 6.25 + 1, 1e-9);
  EXPECT_EQ(m.angle[1], 13.5);
}

TEST(WheelFaults, AFrozenWheelStandsStill) {
  const Changes frozen = fault_named("left frozen").make();
  wheels_t m = some_wheels();
  frozen.wheels(15, m);
  m = some_wheels();
  m.counts[0] += 100, m.angle[0] += 1, m.angle[1] += 1;
  frozen.wheels(15.1, m);
  EXPECT_EQ(m.counts[0], 4096);
  EXPECT_EQ(m.angle[0], 6.25);
  EXPECT_EQ(m.speed[0], 0);
  EXPECT_EQ(m.angle[1], 13.5);
}

TEST(WheelFaults, ASlippingWheelTurnsMoreWhileItSlips) {
  const Changes slips = fault_named("left slips").make();
  wheels_t m;
  // At a constant 10 rad/s, 60 % more in the first half second of each two.
  for (int i = 0; i <= 200; ++i) {
    m = some_wheels(1'000'000 + 10'000 * i);
    m.angle[0] = 6.25 + 0.1 * i;
    m.counts[0] = std::llround(m.angle[0] * 4096 / 6.25);
    const double t = 16 + 0.01 * i;
    slips.wheels(t, m);
    EXPECT_NEAR(m.speed[0], t < 16.495 || t > 17.995 ? 16 : 10, 1e-9) << t;
  }
  EXPECT_NEAR(m.angle[0], 6.25 + 20 + 3, 0.2);
  EXPECT_NEAR(double(m.counts[0]), m.angle[0] * 4096 / 6.25, 2);
  EXPECT_EQ(m.angle[1], 12.5);
}

TEST(WheelFaults, StampsRatesAndSilence) {
  EXPECT_EQ(after(fault_named("wheel stamps late"), some_wheels()).at(0).utime, 1'120'000);
  EXPECT_EQ(after(fault_named("wheel clock set back"), some_wheels(5'000'000)).at(0).utime, 3'000'000);
  EXPECT_TRUE(after(fault_named("wheels silent"), some_wheels()).empty());
  const Changes rare = fault_named("wheels at 1/20 rate").make();
  int sent = 0;
  for (int i = 0; i < 100; ++i) {
    wheels_t m = some_wheels();
    sent += rare.wheels(0, m) ? 1 : 0;
  }
  EXPECT_EQ(sent, 5);
}

TEST(WheelFaults, JumpsStaySpikesGo) {
  const Changes jumps = fault_named("counts jump").make(), spikes = fault_named("wheel spikes").make();
  int spiked = 0;
  double last = 6.25;
  for (int i = 0; i < 2000; ++i) {
    wheels_t m = some_wheels();
    jumps.wheels(20, m);
    EXPECT_GE(m.angle[0], last);
    last = m.angle[0];
    m = some_wheels();
    spikes.wheels(20, m);
    spiked += m.angle[0] != 6.25 ? 1 : 0;
  }
  EXPECT_NEAR((last - 6.25) / 0.7, 10, 6);
  EXPECT_NEAR(spiked, 10, 6);
}

}  // namespace
}  // namespace curbstone::bench::sensor_faults::catalogue
