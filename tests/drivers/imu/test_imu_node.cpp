#include "drivers/imu/imu_node.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/imu_t.hpp>
#include <random>

#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using test::Bytes;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kStart;

/// The driver and an emulated device on a line with delays, on a clock that the test turns.
class ImuNodeTest : public ::testing::Test {
 protected:
  void make_node(const ImuConfig& config = {}) {
    node_ = std::make_unique<ImuNode>(config, recorder_.bus(), [this](std::span<const std::uint8_t> bytes) {
      commands_.insert(commands_.end(), bytes.begin(), bytes.end());
    });
  }

  void deliver(std::int64_t now, const test::Bytes& bytes) {
    if (connected_ && !bytes.empty()) node_->on_bytes(now, bytes);
  }

  /// Runs both ends for `us`: a sample every 10 ms while the device measures, ticks every 20 ms.
  void run_for(std::int64_t us) {
    for (const std::int64_t end = now_ + us; now_ < end; now_ += 10'000) {
      if ((now_ - kStart) % 20'000 == 0) node_->tick(now_);
      if (device_.measuring(now_)) {
        simulate::devices::XsensSample sample;
        const double noise = 1e-9 * static_cast<double>(now_ / 10'000 % 2);  // no sensor is still
        sample.acceleration = {0.1 + 100 * noise, -0.2 + 100 * noise, 9.8 - 1000 * noise};
        sample.angular_rate = {0.01 + noise, 0.02 + noise, 0.03 + noise};
        sample.orientation = {1, 0, 0, 0};
        sample.clipping = clipping_;
        deliver(now_ + delay_(), device_.sample(now_, sample));
      }
      const test::Bytes commands = std::exchange(commands_, {});
      if (connected_ && !commands.empty()) deliver(now_ + 2000, device_.on_bytes(now_ + 1000, commands));
    }
  }
  const std::vector<imu_t>& messages() { return recorder_.messages(); }
  std::int64_t count(std::string_view name) const { return node_->report().counters[name]; }

  test::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::XsensEmulator device_;
  std::unique_ptr<ImuNode> node_;
  test::Bytes commands_;
  bool connected_ = true;
  std::uint32_t clipping_ = 0;
  std::function<std::int64_t()> delay_ = [] { return 0; };
  std::int64_t now_ = kStart;
};

TEST_F(ImuNodeTest, SetsUpANewDeviceAndPublishesWhatItMeasures) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(2'000'000);
  ASSERT_GT(messages().size(), 180u);
  const imu_t& last = messages().back();
  EXPECT_NEAR(last.acceleration[2], 9.8, 1e-6);
  EXPECT_NEAR(last.angular_rate[0], 0.01, 1e-8);
  EXPECT_TRUE(last.has_orientation);
  EXPECT_EQ(last.status, 0);
  EXPECT_TRUE(std::isnan(last.temperature));
  EXPECT_THAT(node_->report().faults, IsEmpty());
  EXPECT_EQ(count("lost.packets"), 0);
  for (std::size_t i = 1; i < messages().size(); ++i) {
    EXPECT_EQ(messages()[i].sequence, messages()[i - 1].sequence + 1);
    EXPECT_EQ(messages()[i].utime - messages()[i - 1].utime, 10'000);
  }
}

/// Setting it up again would lose a moment.
TEST_F(ImuNodeTest, AClockThatIsSetForwardIsNoSilenceOfTheDevice) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(2'000'000);
  now_ += 3'600'000'000;  // us; the next tick comes before the next sample
  run_for(1'000'000);
  EXPECT_EQ(count("device.reconfigured"), 0);
}

TEST_F(ImuNodeTest, FindsADeviceThatIsAlreadyMeasuring) {
  device_.power_on(now_);
  now_ += 5'000'000;
  make_node();
  run_for(1'000'000);
  EXPECT_GT(messages().size(), 90u);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(ImuNodeTest, StampsAreEvenThoughBytesComeLateAndInBunches) {
  std::mt19937 random(1);
  make_node();
  device_.power_on(now_);
  run_for(1'000'000);
  const std::size_t settled = messages().size();
  delay_ = [&] { return static_cast<std::int64_t>(random() % 10 == 0 ? random() % 9'000 : random() % 300); };
  run_for(3'000'000);
  double worst = 0;
  for (std::size_t i = settled; i < messages().size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>((messages()[i].utime - kStart) % 10'000)));
  }
  EXPECT_LE(worst, 100);  // us: a tick of the device
  EXPECT_EQ(count("dropped.not_newer"), 0);
}

TEST_F(ImuNodeTest, WhatCameInABunchBeforeTheFirstPunctualSampleIsNotLost) {
  ImuConfig config;
  config.configure = false;
  device_ = simulate::devices::XsensEmulator({.configured = true});
  make_node(config);
  device_.power_on(now_);
  while (!device_.measuring(now_)) now_ += 10'000;
  std::int64_t due = now_ + 50'000;  // until then the driver is not there to read
  delay_ = [&] { return std::max<std::int64_t>(due - now_, 0); };
  run_for(500'000);
  EXPECT_EQ(count("dropped.not_newer"), 0);
  ASSERT_EQ(messages().size(), 50u);
  for (std::size_t k = 1; k < messages().size(); ++k) {
    EXPECT_EQ(messages()[k].utime - messages()[k - 1].utime, 10'000) << k;
    EXPECT_EQ(messages()[k].sequence, messages()[k - 1].sequence + 1);
  }
}

TEST_F(ImuNodeTest, ADeviceThatRestartsIsSetUpAgainAndStampsGoOn) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(1'000'000);
  const std::size_t before = messages().size();
  deliver(now_, device_.power_on(now_));  // a brown-out: its WakeUp arrives
  run_for(1'000'000);
  EXPECT_GT(messages().size(), before + 80);
  EXPECT_EQ(count("device.restarts"), 2);
  EXPECT_EQ(count("clock_restarts"), 2);  // at each WakeUp
  EXPECT_EQ(count("lost.packets"), 0);
  for (std::size_t i = 1; i < messages().size(); ++i) EXPECT_GT(messages()[i].utime, messages()[i - 1].utime);
}

TEST_F(ImuNodeTest, ADeviceThatFellSilentUnseenIsAFaultAndIsSetUpWhenItComesBack) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(1'000'000);
  connected_ = false;
  run_for(3'500'000);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("no sample from the IMU for 3 s")));
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("does not answer")));
  device_ = simulate::devices::XsensEmulator();  // replaced by one that knows nothing, and its WakeUp is missed
  device_.power_on(now_);
  run_for(1'000'000);
  connected_ = true;
  const std::size_t before = messages().size();
  run_for(2'000'000);
  EXPECT_GT(messages().size(), before + 100);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(ImuNodeTest, AHostClockThatIsSetForwardIsAFaultUntilTheStampsFollow) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(8'000'000);
  EXPECT_THAT(node_->report().faults, IsEmpty());
  EXPECT_GT(count("clock.difference_us"), -10'000);
  delay_ = [] { return 80'000; };  // every time of receipt is later now
  run_for(3'000'000);
  EXPECT_LT(count("clock.difference_us"), -75'000);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("the host's clock was set")));
  run_for(8'000'000);
  EXPECT_GT(count("clock.difference_us"), -10'000);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(ImuNodeTest, LeavesADeviceAloneThatSomebodyElseSetUp) {
  ImuConfig config;
  config.configure = false;
  device_ = simulate::devices::XsensEmulator({.configured = true});
  make_node(config);
  bool sent = false;
  node_ = std::make_unique<ImuNode>(config, recorder_.bus(), [&](auto) { sent = true; });
  deliver(now_, device_.power_on(now_));
  run_for(2'000'000);
  EXPECT_FALSE(sent);
  EXPECT_GT(messages().size(), 140u);
}

TEST_F(ImuNodeTest, GarbageIsCountedReportedAndSurvived) {
  std::mt19937 random(3);
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(1'000'000);
  connected_ = false;
  for (int i = 0; i < 150; ++i) {
    run_for(20'000);
    node_->on_bytes(now_, test::random_bytes(random, 200));
  }
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("garbage from the IMU")));
  const std::size_t before = messages().size();
  connected_ = true;
  run_for(3'000'000);
  EXPECT_GT(messages().size(), before + 180);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(ImuNodeTest, MoreThanAFewRefusedMessagesAreAFaultThatNamesTheirCause) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(2'000'000);
  const auto damage_each = [&](int n) {
    for (int k = 0; k < 200; ++k, now_ += 10'000) {
      test::Bytes bytes = device_.sample(now_, {.acceleration = {k % 2 * 1e-3, k % 2 * 1e-3, 9.8 + k % 2 * 1e-3}});
      if (k % n == 0) bytes[bytes.size() - 2] ^= 0x10;
      deliver(now_, bytes);
      if (k % 2 == 0) node_->tick(now_);
    }
  };
  damage_each(100);
  EXPECT_THAT(node_->report().faults, IsEmpty()) << "one in a hundred";
  damage_each(10);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("refused.checksum")));
  damage_each(1000);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(ImuNodeTest, LossesOnTheWireAreCountedAndSeenInTheSequence) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(1'000'000);
  connected_ = false;
  run_for(50'000);
  connected_ = true;
  run_for(500'000);
  EXPECT_EQ(count("lost.packets"), 5);
}

TEST_F(ImuNodeTest, ALastingClipIsAFaultAndAShockIsNone) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(2'000'000);
  for (int k = 0; k < 10; ++k) {  // kerbs, 0.3 s each
    clipping_ = 1u << 10;
    run_for(300'000);
    EXPECT_THAT(node_->report().faults, IsEmpty());
    clipping_ = 0;
    run_for(700'000);
  }
  for (int k = 0; k < 15; ++k) {  // a vibration: one sample in ten
    clipping_ = 1u << 8;
    run_for(10'000);
    clipping_ = 0;
    run_for(90'000);
  }
  EXPECT_THAT(node_->report().faults, ElementsAre(HasSubstr("the IMU clips")));
  run_for(300'000);
  EXPECT_THAT(node_->report().faults, IsEmpty());
  clipping_ = 1u << 13;
  run_for(1'200'000);
  EXPECT_THAT(node_->report().faults, ElementsAre(HasSubstr("the IMU clips")));
}

TEST_F(ImuNodeTest, ClippingIsMarked) {
  make_node();
  deliver(now_, device_.power_on(now_));
  clipping_ = 1u << 9;
  run_for(500'000);
  EXPECT_EQ(messages().back().status, imu_t::CLIPPING);
}

TEST_F(ImuNodeTest, APortThatVanishesIsAFaultUntilItIsBack) {
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(500'000);
  node_->on_link(now_, link::LinkState::kDown, "serial port /dev/x has vanished");
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("/dev/x has vanished")));
  connected_ = false;
  run_for(2'000'000);
  connected_ = true;
  node_->on_link(now_, link::LinkState::kUp, "");
  run_for(1'000'000);
  EXPECT_THAT(node_->report().faults, IsEmpty());
  EXPECT_EQ(count("link.lost"), 1);
  EXPECT_EQ(count("link.reopened"), 1);
}

TEST_F(ImuNodeTest, OnAUartStampsAreThoseOfTheFirstByte) {
  ImuConfig config;
  config.line = Line::kUart;
  make_node(config);
  deliver(now_, device_.power_on(now_));
  delay_ = [] { return simulate::devices::XsensEmulator::transmission_time(73, 115200); };
  run_for(2'000'000);
  EXPECT_NEAR(static_cast<double>((messages().back().utime - kStart) % 10'000), 0, 400);
}

}  // namespace
}  // namespace curbstone::imu
