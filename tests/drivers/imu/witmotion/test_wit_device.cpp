#include "drivers/imu/witmotion/wit_device.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/imu_t.hpp>
#include <numbers>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/wit_emulator.hpp"

namespace curbstone::imu::witmotion {
namespace {

using test::Bytes;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kStart;

TEST(WitDevice, TheWorkedFramesGiveTheirValues) {
  WitDevice device({.configure = false}, [](auto) {});
  test::Bytes bytes;
  for (int i = 0; i < 2; ++i) {
    for (const char* frame : {"55 51 00 00 00 00 00 08 CA 09 81", "55 52 00 00 00 00 9A F9 CA 09 0D",
                              "55 53 00 20 00 F0 00 40 00 00 F8", "55 59 FF 7F 00 00 00 00 00 00 2C"}) {
      test::append(bytes, test::from_hex(frame));
    }
  }
  std::vector<device::ImuSample> samples;
  device.on_bytes(kStart, bytes, [&](const device::ImuSample& sample) { samples.push_back(sample); });
  ASSERT_EQ(samples.size(), 2u) << "the first group ends with the second's first frame";
  EXPECT_NEAR(samples[0].acceleration[2], 9.80665, 1e-9);
  EXPECT_NEAR(samples[0].angular_rate[2], -99.976 * std::numbers::pi / 180, 1e-4);
  EXPECT_NEAR(*samples[0].temperature, 25.06, 1e-9);
  EXPECT_NEAR((*samples[0].orientation)[0], 1, 1e-9);
  EXPECT_FALSE(samples[0].force_clips);
  EXPECT_EQ(samples[0].rate_clips, (std::array<bool, 3>{}));
  EXPECT_FALSE(samples[0].time);
}

/// The first group shows by its end, when the next begins, what a whole one is: its stamp is of its own bytes all the
/// same. One that came out too early would be believed for seconds (ClockOffset).
TEST(WitDevice, OnAUartTheFirstGroupIsStampedAsTheOthersAre) {
  for (const int baud : {9600, 115200}) {
    WitDevice device({.configure = false, .baud = baud, .uart = true}, [](auto) {});
    simulate::devices::WitEmulator emulator;
    emulator.power_on(kStart);
    std::vector<device::ImuSample> samples;
    for (int i = 0; i < 5; ++i) {
      const std::int64_t begin = kStart + i * 100'000;
      const Bytes bytes = emulator.sample(begin, {.acceleration = {0, 0, 9.8}});
      for (std::size_t k = 0; k < bytes.size(); ++k) {
        const auto sent = static_cast<std::int64_t>(k + 1) * 10'000'000 / baud;
        device.on_bytes(begin + sent, std::span(bytes).subspan(k, 1),
                        [&](const device::ImuSample& sample) { samples.push_back(sample); });
      }
    }
    ASSERT_EQ(samples.size(), 5u);
    for (int i = 0; i < 5; ++i)
      EXPECT_NEAR(static_cast<double>(samples[static_cast<std::size_t>(i)].received), kStart + i * 100'000, 100)
          << i << ", " << baud;
  }
}

/// The node and an emulated device.
class WitNodeTest : public ::testing::Test {
 protected:
  void make_node(Model model = Model::kWitMotion, bool configure = true) {
    ImuConfig config;
    config.model = model;
    config.configure = configure;
    node_ = std::make_unique<ImuNode>(config, recorder_.bus(), [this](auto bytes) { device_.on_bytes(bytes); });
    device_.power_on(now_);
  }
  /// A group of frames at a time; `damage` may change it.
  void run_for(std::int64_t us, const std::function<void(test::Bytes&, int)>& damage = nullptr) {
    int group = 0;
    for (const std::int64_t end = now_ + us; now_ < end;) {
      now_ += device_.period();
      node_->tick(now_);
      noise_ = 0.005 - noise_;  // no sensor is still
      test::Bytes bytes = device_.sample(
          now_, {.acceleration = {0.1 + noise_, -0.2 + noise_, 9.8 - noise_}, .orientation = {{1, 0, 0, 0}}});
      if (damage) damage(bytes, group++);
      if (connected_) node_->on_bytes(now_ + 500, bytes);
    }
  }
  const std::vector<imu_t>& messages() { return recorder_.messages(); }
  std::int64_t count(std::string_view name) const { return node_->report().counters[name]; }

  test::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::WitEmulator device_;
  std::unique_ptr<ImuNode> node_;
  bool connected_ = true;
  double noise_ = 0;  // m/s^2
  std::int64_t now_ = kStart;
};

TEST_F(WitNodeTest, IsSetUpAndItsSamplesBearTheTimeOfTheDevice) {
  make_node();
  run_for(3'000'000);
  EXPECT_EQ(device_.period(), 10'000);
  ASSERT_GT(messages().size(), 200u);
  const imu_t& last = messages().back();
  EXPECT_NEAR(last.acceleration[2], 9.8, 0.01);
  EXPECT_TRUE(last.has_orientation);
  EXPECT_NEAR(last.temperature, 25, 0.01);
  EXPECT_THAT(node_->report().faults, IsEmpty());
  for (std::size_t i = messages().size() - 100; i < messages().size(); ++i) {
    EXPECT_EQ(messages()[i].utime - messages()[i - 1].utime, 10'000);
    EXPECT_EQ(messages()[i].sequence - messages()[i - 1].sequence, 1);
  }
}

TEST_F(WitNodeTest, NothingIsSentToADeviceThatSomebodyElseSetUp) {
  make_node(Model::kWitMotion, false);
  run_for(2'000'000);
  EXPECT_EQ(device_.period(), 100'000);
  EXPECT_GE(messages().size(), 18u);
  EXPECT_GT(count("stamped_on_receipt"), 0) << "it sends no time as it is bought";
}

TEST_F(WitNodeTest, ADamagedFrameCostsItsSampleAndItsFollowersKeepTheirTimes) {
  make_node();
  run_for(2'000'000);
  const std::size_t before = messages().size();
  const std::int64_t refused = count("refused.checksum");
  int damaged = 0;
  run_for(10'000'000, [&](test::Bytes& bytes, int group) {
    if (group % 20 != 10) return;
    bytes[static_cast<std::size_t>(group / 20 % 4) * 11 + 5] ^= 0x08;
    ++damaged;
  });
  EXPECT_EQ(count("refused.checksum") - refused, damaged);
  EXPECT_EQ(count("lost.packets"), damaged);
  EXPECT_EQ(messages().size() - before, static_cast<std::size_t>(1000 - damaged));
  for (std::size_t i = before; i < messages().size(); ++i) {
    EXPECT_EQ((messages()[i].utime - kStart) % 10'000, messages()[before].utime % 10'000) << i;
    EXPECT_TRUE(messages()[i].has_orientation);
  }
}

TEST_F(WitNodeTest, AFrameThatIsMissingMixesNoSamples) {
  make_node();
  run_for(2'000'000);
  const std::size_t before = messages().size();
  const std::int64_t refused = count("refused.group");  // while it was set up
  run_for(4'000'000, [&](test::Bytes& bytes, int group) {
    if (group % 40 != 20) return;
    const auto begin = bytes.begin() + (group / 40 % 4) * 11;
    bytes.erase(begin, begin + 11);
  });
  EXPECT_EQ(count("refused.group") - refused, 10);
  EXPECT_EQ(messages().size() - before, 390u);
  for (std::size_t i = before; i < messages().size(); ++i) {
    EXPECT_EQ((messages()[i].utime - kStart) % 10'000, messages()[before].utime % 10'000) << i;
  }
}

TEST_F(WitNodeTest, ADeviceThatWasOffIsSetUpAgain) {
  make_node();
  run_for(2'000'000);
  device_.power_on(now_);
  EXPECT_EQ(device_.period(), 100'000);
  run_for(3'000'000);
  EXPECT_EQ(device_.period(), 10'000);
  const std::size_t before = messages().size();
  run_for(1'000'000);
  EXPECT_GT(messages().size(), before + 90);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(WitNodeTest, AClockThatIsSetForwardIsNoSilenceOfTheDevice) {
  make_node();
  run_for(4'000'000);
  const std::int64_t commands = count("device.commands");
  now_ += 3'600'000'000;  // us; the next tick comes before the next sample
  run_for(1'000'000);
  EXPECT_EQ(count("device.commands"), commands);
}

TEST_F(WitNodeTest, ARateThatTheDeviceDoesNotHaveIsReported) {
  ImuConfig config;
  config.model = Model::kWitMotion;
  config.rate = 400;
  const ImuNode node(config, recorder_.bus());
  EXPECT_THAT(node.report().faults, Contains(HasSubstr("no 400 Hz: it is set to 200 Hz")));
}

TEST_F(WitNodeTest, ByItsFramesItIsRecognised) {
  make_node(Model::kAuto);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("no model of IMU")));
  run_for(3'000'000);
  EXPECT_EQ(device_.period(), 10'000);
  EXPECT_GT(messages().size(), 100u);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(WitNodeTest, NoBytesHarmIt) {
  std::mt19937 random(3);
  make_node();
  run_for(2'000'000);
  for (int round = 0; round < 5000; ++round) {
    test::Bytes bytes = test::random_bytes(random, random() % 60);
    for (auto& byte : bytes) byte = random() % 3 == 0 ? static_cast<std::uint8_t>(0x50 + random() % 11) : byte;
    node_->on_bytes(now_ += 1000, bytes);
    if (random() % 3 == 0) node_->on_bytes(now_, device_.sample(now_, {.acceleration = {0, 0, 9.8}}));
  }
  for (const imu_t& message : messages()) EXPECT_TRUE(std::isfinite(message.acceleration[0]));
  const std::size_t before = messages().size();
  run_for(3'000'000);
  EXPECT_GT(messages().size(), before + 200);
}

}  // namespace
}  // namespace curbstone::imu::witmotion
