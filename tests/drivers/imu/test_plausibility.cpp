#include "drivers/imu/plausibility.hpp"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <curbstone/imu_t.hpp>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bytes/big_endian.hpp"
#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using simulate::devices::XsensSample;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kStart;

struct LastingFault {
  const char* name;
  const char* counter;
  const char* fault;
  double most;  // s until nothing of it is published
  std::function<void(XsensSample&)> spoil;
};

/// An MTi on a vehicle that drives, over the wire, with its noise.
class DrivenImu : public ::testing::Test {
 protected:
  DrivenImu() : node_(ImuConfig{.configure = false}, recorder_.bus()) { device_.power_on(kStart - 5'000'000); }
  void drive(double seconds, const std::function<void(XsensSample&)>& spoil = {}) {
    for (const std::int64_t end = now_ + std::llround(seconds * 1e6); now_ < end; now_ += 10'000) {
      const double t = static_cast<double>(now_ - kStart) * 1e-6;
      XsensSample sample;
      sample.acceleration = {2 * std::sin(t) + noise(0.3), noise(0.3), 9.81 + noise(0.5)};
      sample.angular_rate = {noise(0.01), noise(0.01), 0.4 * std::sin(0.7 * t) + noise(0.01)};
      if (spoil) spoil(sample);
      node_.on_bytes(now_ + 200, device_.sample(now_, sample));
      node_.tick(now_ + 300);
    }
  }
  double noise(double sigma) { return std::normal_distribution<>(0, sigma)(random_); }
  std::size_t published() { return recorder_.messages().size(); }

  test::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::XsensEmulator device_{{.configured = true}};
  ImuNode node_;
  std::int64_t now_ = kStart;
  std::mt19937 random_{1};
};

class ImplausibleImu : public DrivenImu, public ::testing::WithParamInterface<LastingFault> {};

TEST_P(ImplausibleImu, IsNamedWithheldAndUsedAgain) {
  drive(10);
  ASSERT_EQ(published(), 1000U);
  ASSERT_THAT(node_.report().faults, IsEmpty());
  drive(GetParam().most, GetParam().spoil);
  const std::size_t before = published();
  for (int k = 0; k < 20; ++k) {
    drive(3, GetParam().spoil);
    EXPECT_THAT(node_.report().faults, ElementsAre(HasSubstr(GetParam().fault)));
  }
  EXPECT_EQ(published(), before);
  EXPECT_GE(node_.report().counters[GetParam().counter], 6000);
  drive(2);
  const std::size_t after = published();
  EXPECT_THAT(node_.report().faults, IsEmpty());
  drive(10);
  EXPECT_EQ(published() - after, 1000U);
  EXPECT_EQ(node_.report().counters["lost.packets"], 0);
}
INSTANTIATE_TEST_SUITE_P(
    Lasting, ImplausibleImu,
    ::testing::Values(LastingFault{"StuckAccelerometer", "withheld.stuck_accelerometer", "accelerometer is stuck", 2.1,
                                   [](auto& s) {
                                     s.acceleration = {0.1, -0.2, 9.8};
                                   }},
                      LastingFault{"OneSampleOverAndOver", "withheld.frozen", "repeats one sample", 0.06,
                                   [](auto& s) {
                                     s.acceleration = {0.1, -0.2, 9.8};
                                     s.angular_rate = {0.01, 0.02, 0.03};
                                   }},
                      LastingFault{"DeadHorizontalAxis", "withheld.stuck_accelerometer", "accelerometer is stuck", 3.1,
                                   [](auto& s) { s.acceleration[1] = 0; }},
                      LastingFault{"TwoFrozenAxes", "withheld.stuck_accelerometer", "accelerometer is stuck", 3.1,
                                   [](auto& s) {
                                     s.acceleration[0] = 0.1;
                                     s.acceleration[1] = -0.2;
                                   }},
                      LastingFault{"NoisyDeadVerticalAxis", "withheld.not_gravity", "not gravity", 4.1,
                                   [](auto& s) { s.acceleration[2] -= 9.81; }},
                      LastingFault{"HalfTheScale", "withheld.not_gravity", "not gravity", 4.1,
                                   [](auto& s) {
                                     for (double& a : s.acceleration) a /= 2;
                                   }},
                      LastingFault{"TwiceTheScale", "withheld.not_gravity", "not gravity", 4.1,
                                   [](auto& s) {
                                     for (double& a : s.acceleration) a *= 2;
                                   }},
                      LastingFault{"UnitIsG", "withheld.not_gravity", "not gravity", 4.1,
                                   [](auto& s) {
                                     for (double& a : s.acceleration) a /= 9.80665;
                                   }},
                      LastingFault{"GyroStuckAtZero", "withheld.stuck_gyro", "gyro is stuck", 4.1,
                                   [](auto& s) {
                                     s.angular_rate = {0, 0, 0};
                                   }},
                      LastingFault{"GyroStuckInABend", "withheld.stuck_gyro", "gyro is stuck", 0.6,
                                   [](auto& s) {
                                     s.angular_rate = {0.2, -0.3, 0.4};
                                   }}),
    [](const auto& test) { return test.param.name; });

/// The others are good, and the filter needs them.
TEST_F(DrivenImu, AxesOfTheGyroThatAreStuckAreNamedAndTheOthersGoOn) {
  drive(10);
  for (const unsigned stuck : {1u, 2u, 4u, 3u, 6u}) {
    for (const double rate : {0.12, -34.9}) {
      const auto spoil = [&](XsensSample& s) {
        for (std::size_t i = 0; i < 3; ++i) {
          if ((stuck >> i & 1u) == 0) continue;
          s.angular_rate[i] = rate;
          if (rate < -30) s.clipping |= 1u << (11 + i);
        }
      };
      const std::size_t before = published();
      drive(0.6, spoil);
      const std::size_t named = published();
      drive(10, spoil);
      EXPECT_EQ(published() - before, 1060U) << "none is withheld";
      for (std::size_t i = named; i < published(); ++i)
        ASSERT_EQ(recorder_.messages()[i].status, static_cast<std::int32_t>(stuck << 2)) << rate;
      const NodeReport report = node_.report();
      EXPECT_EQ(report.faults.size(), static_cast<std::size_t>(std::popcount(stuck))) << stuck;
      for (const std::string& fault : report.faults) EXPECT_THAT(fault, HasSubstr("stuck or at the end of its range"));
      drive(2);
      EXPECT_EQ(recorder_.messages().back().status, 0);
      EXPECT_THAT(node_.report().faults, IsEmpty());
    }
  }
  NodeReport report = node_.report();
  EXPECT_GT(report.counters["stuck.gyro_x"], 4000);
  EXPECT_GT(report.counters["stuck.gyro_z"], 4000);
  EXPECT_EQ(report.counters["withheld.stuck_gyro"], 0);
}

/// Standing, where nothing is felt: two axes of three tell as much in 3 s as three in 2 s.
TEST_F(DrivenImu, TwoAxesOfTheAccelerometerThatAreStuckAreFoundWithoutMotion) {
  const auto stand = [&](XsensSample& s) {
    s.acceleration = {0.1 + noise(0.02), -0.2 + noise(0.02), 9.81 + noise(0.02)};
  };
  const auto stuck = [&](XsensSample& s) {
    stand(s);
    s.acceleration[1] = -0.2;
    s.acceleration[2] = 9.81;
  };
  drive(10, stand);
  drive(3.1, stuck);
  const std::size_t before = published();
  drive(20, stuck);
  EXPECT_EQ(published(), before);
  EXPECT_THAT(node_.report().faults, ElementsAre(HasSubstr("accelerometer is stuck")));
  drive(2, stand);
  EXPECT_THAT(node_.report().faults, IsEmpty());
}

/// Samples of a device whose values have steps, straight into the judge. @return how many it withholds.
int withheld(int rate, double seconds, const std::function<std::array<double, 3>(double)>& acceleration,
             const std::function<std::array<double, 3>(double)>& angular_rate) {
  Plausibility judge;
  int count = 0;
  for (int i = 0; i < rate * seconds; ++i) {
    const double t = static_cast<double>(i) / rate;
    const auto verdict = judge.judge(kStart + std::llround(t * 1e6), acceleration(t), angular_rate(t));
    count += verdict == Plausibility::Verdict::kGood ? 0 : 1;
  }
  return count;
}

TEST(Plausibility, AWitMotionThatStandsForHoursWithItsGyroAtZeroIsGood) {
  constexpr double kStep = 16.0 / 32768 * 9.80665;
  std::mt19937 random(1);
  for (const auto& [rate, density] : std::vector<std::pair<int, double>>{
           {10, 300e-6}, {100, 300e-6}, {200, 300e-6}, {10, 70e-6}, {100, 70e-6}, {200, 70e-6}}) {  // g/sqrt(Hz)
    std::normal_distribution<> noise(0, density * 9.80665 * std::sqrt(5 * 1.57));                   // behind 5 Hz
    std::array<double, 3> slow{};
    const double keep = std::exp(-2 * 3.14159 * 5 / rate);
    const auto acceleration = [&](double) {
      std::array<double, 3> a{0, 0, 9.80665};
      for (std::size_t i = 0; i < 3; ++i) {
        slow[i] = keep * slow[i] + std::sqrt(1 - keep * keep) * noise(random);
        a[i] = kStep * std::round((a[i] + slow[i]) / kStep);
      }
      return a;
    };
    EXPECT_EQ(withheld(rate, 7200, acceleration, [](double) { return std::array<double, 3>{}; }), 0)
        << rate << " Hz, " << density;
  }
}

class Recorded : public ::testing::TestWithParam<int> {};

/// A second of an MTi that lies still, twenty times on end: each of its formats (file 5 has no inertial data).
TEST_P(Recorded, XsensIsGood) {
  const std::string file = test::data_path("imu_xsens/" + std::to_string(GetParam()) + ".output.bin");
  const test::Bytes bytes = test::read_bytes(file);
  if (bytes.empty()) GTEST_SKIP() << file << " is not there";
  test::Recorder<imu_t> recorder("IMU");
  ImuNode node(ImuConfig{.configure = false}, recorder.bus());
  std::int64_t now = kStart;
  for (std::span<const std::uint8_t> rest = bytes; !rest.empty(); rest = rest.subspan(rest[3] + std::size_t{5})) {
    node.on_bytes(now += 10'000, rest.first(rest[3] + std::size_t{5}));
  }
  node.finish();
  ASSERT_GT(recorder.messages().size(), 90U);
  EXPECT_EQ(node.report().counters["refused.range"], 0);
  Plausibility judge;
  int withheld = 0;
  for (int k = 0; k < 20; ++k) {
    for (const imu_t& m : recorder.messages()) {
      const auto verdict =
          judge.judge(now += 10'000, std::to_array(m.acceleration), std::to_array(m.angular_rate), true);
      withheld += verdict == Plausibility::Verdict::kGood ? 0 : 1;
    }
  }
  EXPECT_EQ(withheld, 0);
}
INSTANTIATE_TEST_SUITE_P(Files, Recorded, ::testing::Range(1, 5));

/// The IMU of a small robot with 16-bit steps (2 g, 250 deg/s), 20 Hz, 69 s: it stands, drives and turns.
TEST(Plausibility, ARealRobotsDriveIsGood) {
  const test::Bytes log = test::read_bytes(test::data_path("lcm/botlab_convex.lcmlog"));
  if (log.empty()) GTEST_SKIP() << "lcm/botlab_convex.lcmlog is not there";
  const auto at = [&](std::size_t offset) { return std::span(log).subspan(offset); };
  const auto number = [&](std::size_t offset) {
    return std::bit_cast<double>(read_big_endian<std::uint64_t>(at(offset)));
  };
  Plausibility judge;
  int samples = 0, withheld = 0;
  for (std::size_t i = 0; i + 28 <= log.size();) {  // sync, number, time, lengths of channel and message
    const auto time = static_cast<std::int64_t>(read_big_endian<std::uint64_t>(at(i + 12)));
    const std::size_t channel = read_big_endian<std::uint32_t>(at(i + 20));
    const std::size_t message = i + 28 + channel;
    const std::string name(log.begin() + static_cast<std::ptrdiff_t>(i) + 28,
                           log.begin() + static_cast<std::ptrdiff_t>(message));
    i = message + read_big_endian<std::uint32_t>(at(i + 24));
    if (name != "MAEBOT_IMU") continue;
    std::array<double, 3> acceleration, rate;
    for (std::size_t k = 0; k < 3; ++k) {
      acceleration[k] = number(message + 16 + 8 * k) / 16384 * 9.80665;
      rate[k] = number(message + 40 + 8 * k) / 131 * 3.14159 / 180;
    }
    ++samples;
    withheld += judge.judge(time, acceleration, rate) == Plausibility::Verdict::kGood ? 0 : 1;
  }
  EXPECT_EQ(samples, 1376);
  EXPECT_EQ(withheld, 0);
}

TEST(Plausibility, HardBrakingAndALongBendAreGood) {
  std::mt19937 random(1);
  std::normal_distribution<> noise(0, 0.01);
  const auto acceleration = [&](double t) {
    const bool brakes = std::fmod(t, 10) < 4;
    return std::array{(brakes ? -9.0 : 0) + noise(random), (brakes ? 0.0 : 7.0) + noise(random), 9.8 + noise(random)};
  };
  const auto rate = [&](double) { return std::array{noise(random), noise(random), 0.5 + noise(random)}; };
  EXPECT_EQ(withheld(100, 100, acceleration, rate), 0);
}

}  // namespace
}  // namespace curbstone::imu
