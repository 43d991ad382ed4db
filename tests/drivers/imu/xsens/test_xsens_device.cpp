#include "drivers/imu/xsens/xsens_device.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>

#include "common/bytes/big_endian.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"

namespace curbstone::imu::xsens {
namespace {

using device::ImuSample;
using test::Bytes;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

using test::kStart;

class XsensDeviceTest : public ::testing::Test {
 protected:
  /// The increments of a device that turns and accelerates evenly, as float64; `n` samples after the first.
  test::Bytes increments(int n, double hz) const {
    test::Bytes payload;
    const auto item = [&](std::uint16_t id, std::size_t size) {
      append_big_endian(payload, id);
      payload.push_back(static_cast<std::uint8_t>(size));
    };
    const auto number = [&](double value) { append_big_endian(payload, std::bit_cast<std::uint64_t>(value)); };
    item(0x1020, 2);
    append_big_endian(payload, static_cast<std::uint16_t>(n));
    item(0x1060, 4);
    append_big_endian(payload, static_cast<std::uint32_t>(std::llround(n * 10'000 / hz)));
    item(0x4013, 24);
    for (const double a : acceleration_) number(a / hz);
    const double turn = std::hypot(rate_[0], rate_[1], rate_[2]) / hz;
    item(0x8033, 32);
    number(sign_ * std::cos(turn / 2));
    for (const double w : rate_) number(sign_ * std::sin(turn / 2) * w / hz / turn);
    return encode_xbus(Mid::kMtData2, payload);
  }
  void feed(std::int64_t now, std::span<const std::uint8_t> bytes) {
    device_.on_bytes(now, bytes, [this](const ImuSample& sample) { samples_.push_back(sample); });
  }

  const std::array<double, 3> acceleration_ = {0.5, -1.5, 9.8};
  std::array<double, 3> rate_ = {0.3, -0.2, 5.0};
  double sign_ = 1;
  XsensDevice device_{{.configure = false}, [](auto) {}};
  std::vector<ImuSample> samples_;
};

TEST_F(XsensDeviceTest, IncrementsBecomeRatesByTheSampleInterval) {
  for (const double hz : {100.0, 60.0, 400.0}) {
    for (const double sign : {1.0, -1.0}) {
      SCOPED_TRACE(::testing::Message() << hz << " " << sign);
      XsensDevice device({.configure = false}, [](auto) {});
      sign_ = sign;
      samples_.clear();
      for (int n = 0; n < 100; ++n) {
        const auto received = kStart + std::llround(n * 1e6 / hz);
        device.on_bytes(received, increments(n, hz), [this](const ImuSample& s) { samples_.push_back(s); });
      }
      EXPECT_EQ(device.counters()["skipped.no_interval"], 3) << "three steps show it";
      ASSERT_EQ(samples_.size(), 97u);
      const ImuSample& last = samples_.back();
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(last.acceleration[i], acceleration_[i], 5e-4 * std::abs(acceleration_[i]));
        EXPECT_NEAR(last.angular_rate[i], rate_[i], 5e-4 * std::abs(rate_[i]));
      }
    }
  }
}

TEST_F(XsensDeviceTest, AnIncrementAfterALossIsThatOfOneInterval) {
  for (int n = 0; n < 60; ++n) {
    if (n >= 40 && n < 43) continue;
    feed(kStart + n * 10'000, increments(n, 100));
  }
  EXPECT_EQ(device_.counters()["lost.packets"], 3);
  for (const ImuSample& sample : samples_) EXPECT_NEAR(sample.acceleration[2], 9.8, 1e-9);
}

/// A frame that has lost bytes and took as many from its follower: its sum is right once in 256 times, and what comes
/// before the loss looks like a sample.
TEST_F(XsensDeviceTest, AMessageWhoseItemsDoNotComeOutEvenIsNotUsed) {
  for (int n = 0; n < 60; ++n) {
    const test::Bytes good = increments(n, 100);
    test::Bytes payload(good.begin() + 4, good.end() - 1);
    if (n >= 40 && n < 50) payload.resize(payload.size() + 1 + static_cast<std::size_t>(n) % 3, 0xFA);
    if (n >= 50 && n < 55) test::append(payload, test::from_hex("E0 20 04 00 00"));
    feed(kStart + n * 10'000, encode_xbus(Mid::kMtData2, payload));
  }
  EXPECT_EQ(device_.counters()["refused.truncated"], 15);
  EXPECT_EQ(device_.counters()["lost.packets"], 15);
  EXPECT_EQ(samples_.size(), 57u - 15);
}

TEST_F(XsensDeviceTest, NoTurnIsNoRate) {
  rate_ = {1e-12, 0, 0};
  for (int n = 0; n < 20; ++n) feed(kStart + n * 10'000, increments(n, 100));
  EXPECT_THAT(samples_.back().angular_rate,
              ElementsAre(DoubleNear(0, 1e-9), DoubleNear(0, 1e-12), DoubleNear(0, 1e-12)));
}

TEST_F(XsensDeviceTest, RecordedIncrementsAgreeWithTheRatesBesideThem) {
  for (int file = 1; file <= 4; ++file) {  // float32, 12.20, 16.32, float64
    const std::string name = test::data_path("imu_xsens/") + std::to_string(file) + ".output.bin";
    const test::Bytes bytes = test::read_bytes(name);
    if (bytes.empty()) GTEST_SKIP() << name << " is not there";
    XsensDevice device({.configure = false}, [](auto) {});
    std::int64_t now = kStart;
    double worst_acceleration = 0, worst_rate = 0;
    int compared = 0;
    for (std::span<const std::uint8_t> rest = bytes; !rest.empty(); now += 10'000) {
      const auto frame = rest.first(rest[3] + std::size_t{5});
      rest = rest.subspan(frame.size());
      Counters ignored;
      const MtData2 data = decode_mtdata2(frame.subspan(4, frame.size() - 5), ignored);
      device.on_bytes(now, frame, [&](const ImuSample& sample) {
        ++compared;
        for (std::size_t i = 0; i < 3; ++i) {
          worst_acceleration = std::max(worst_acceleration, std::abs(sample.acceleration[i] - (*data.acceleration)[i]));
          worst_rate = std::max(worst_rate, std::abs(sample.angular_rate[i] - (*data.angular_rate)[i]));
        }
      });
    }
    EXPECT_EQ(compared, 96);
    EXPECT_LT(worst_acceleration, 6e-4) << "the rest is the compensation";
    EXPECT_LT(worst_rate, file == 2 ? 5e-4 : 1e-6) << "12.20 has steps of 2e-4 rad/s at 100 Hz";
    EXPECT_GT(worst_acceleration, 1e-5) << "it was the increments that were used";
  }
}

}  // namespace
}  // namespace curbstone::imu::xsens
