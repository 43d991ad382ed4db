// Faults in what an Xsens sends: what is bad costs itself, and nothing of it is published.
#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/imu_t.hpp>
#include <limits>
#include <random>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using test::kStart;

class FaultySamples : public ::testing::Test {
 protected:
  FaultySamples() : node_(ImuConfig{.configure = false}, recorder_.bus(), [](std::span<const std::uint8_t>) {}) {
    device_.power_on(kStart);
    now_ += 5'000'000;
  }
  /// One sample, as `spoil` leaves its values and `garble` its bytes.
  void sample(const std::function<void(simulate::devices::XsensSample&)>& spoil = {}, bool garble = false) {
    simulate::devices::XsensSample sample;
    const double noise = now_ / 10'000 % 2 == 0 ? 1e-7 : 0;  // no sensor is still
    sample.acceleration = {0.1 + noise, -0.2 + noise, 9.8 - 9 * noise};
    sample.angular_rate = {0.01 + noise, 0.02 + noise, 0.03 + 1e-8 * static_cast<double>(now_ / 10'000 % 7)};
    sample.orientation = {1, 0, 0, 0};
    if (spoil) spoil(sample);
    EXPECT_TRUE(device_.measuring(now_));
    test::Bytes bytes = device_.sample(now_, sample);
    if (garble) bytes = test::random_bytes(random_, bytes.size());
    node_.on_bytes(now_ + 200, bytes);
    node_.tick(now_ + 300);
    now_ += 10'000;
  }
  std::int64_t count(const char* name) const { return node_.report().counters[name]; }
  void expect_true_messages() {
    for (const imu_t& message : recorder_.messages()) {
      EXPECT_NEAR(message.acceleration[2], 9.8, 1e-6);
      EXPECT_NEAR(message.angular_rate[0], 0.01, 1e-6);
      EXPECT_LE(std::abs((message.utime - 200 - kStart + 5'000) % 10'000 - 5'000), 100) << "us";
    }
  }

  test::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::XsensEmulator device_{{.configured = true}};
  ImuNode node_;
  std::int64_t now_ = kStart;
  std::mt19937 random_{1};
};

TEST_F(FaultySamples, NumbersThatAreNoneAreNotPublished) {
  for (int i = 0; i < 50; ++i) sample();
  const std::size_t before = recorder_.messages().size();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e30}) {
    sample([&](auto& s) { s.acceleration[1] = bad; });
    sample();
    sample([&](auto& s) { s.angular_rate[2] = -bad; });
    sample();
  }
  EXPECT_EQ(recorder_.messages().size() - before, 6U);
  EXPECT_EQ(count("refused.not_finite") + count("refused.range"), 6);
  EXPECT_EQ(count("refused.time"), 0);
  expect_true_messages();
}

TEST_F(FaultySamples, ABaudThatChangesInMidStreamIsReportedAndItsSamplesAreLost) {
  for (int i = 0; i < 100; ++i) sample();
  const std::size_t before = recorder_.messages().size();
  for (int i = 0; i < 300; ++i) sample({}, true);
  EXPECT_EQ(recorder_.messages().size(), before);
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("garbage from the IMU: wrong baud")));
  for (int i = 0; i < 300; ++i) sample();
  EXPECT_GE(recorder_.messages().size() - before, 297U);
  EXPECT_GE(count("lost.packets"), 299);
  EXPECT_EQ(node_.report().faults.size(), 0U);
  expect_true_messages();
}

}  // namespace
}  // namespace curbstone::imu
