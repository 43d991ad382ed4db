#include "drivers/imu/imu_node.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/imu_t.hpp>
#include <random>

#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using testing::Bytes;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

/// The driver and an emulated device on a line with delays, on a clock that the test turns.
class ImuNodeTest : public ::testing::Test {
 protected:
  void make_node(const ImuConfig& config = {}) {
    node_ = std::make_unique<ImuNode>(config, recorder_.bus(), [this](std::span<const std::uint8_t> bytes) {
      commands_.insert(commands_.end(), bytes.begin(), bytes.end());
    });
  }

  void deliver(std::int64_t now, const testing::Bytes& bytes) {
    if (connected_ && !bytes.empty()) node_->on_bytes(now, bytes);
  }

  /// Runs both ends for `us`: a sample every 10 ms while the device measures, ticks every 20 ms.
  void run_for(std::int64_t us) {
    for (const std::int64_t end = now_ + us; now_ < end; now_ += 10'000) {
      if ((now_ - kStart) % 20'000 == 0) node_->tick(now_);
      if (device_.measuring(now_)) {
        simulate::devices::XsensSample sample;
        sample.acceleration = {0.1, -0.2, 9.8};
        sample.angular_rate = {0.01, 0.02, 0.03};
        sample.orientation = {1, 0, 0, 0};
        sample.clipping = clipping_;
        deliver(now_ + delay_(), device_.sample(now_, sample));
      }
      const testing::Bytes commands = std::exchange(commands_, {});
      if (connected_ && !commands.empty()) deliver(now_ + 2000, device_.on_bytes(now_ + 1000, commands));
    }
  }
  const std::vector<imu_t>& messages() { return recorder_.messages(); }
  std::int64_t count(std::string_view name) const { return node_->report().counters[name]; }

  testing::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::XsensEmulator device_;
  std::unique_ptr<ImuNode> node_;
  testing::Bytes commands_;
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

TEST_F(ImuNodeTest, GarbageIsCountedToldAndSurvived) {
  std::mt19937 random(3);
  make_node();
  deliver(now_, device_.power_on(now_));
  run_for(1'000'000);
  connected_ = false;
  for (int i = 0; i < 150; ++i) {
    run_for(20'000);
    node_->on_bytes(now_, testing::random_bytes(random, 200));
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
      testing::Bytes bytes = device_.sample(now_, {.acceleration = {0, 0, 9.8}});
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
  node_->on_link(now_, false, "serial port /dev/x has vanished");
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("/dev/x has vanished")));
  connected_ = false;
  run_for(2'000'000);
  connected_ = true;
  node_->on_link(now_, true, "");
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

/// A recording of an Xsens with a GNSS receiver, a message at a time, at the pace of the device.
class RecordedStream : public ImuNodeTest {
 protected:
  void SetUp() override {
    const std::string file = CURBSTONE_DATA_DIR "/imu_xsens/1.output.bin";
    const testing::Bytes bytes = testing::read_bytes(file);
    if (bytes.empty()) GTEST_SKIP() << file << " is not there";
    for (std::span<const std::uint8_t> rest = bytes; !rest.empty(); rest = rest.subspan(rest[3] + std::size_t{5})) {
      frames_.emplace_back(rest.begin(), rest.begin() + rest[3] + 5);
    }
    ImuConfig config;
    config.configure = false;
    make_node(config);
  }
  static bool has_inertia(const testing::Bytes& frame) { return frame[4] == 0x10; }  // its first item is the counter
  /// The bytes of item `id` in a frame.
  static std::span<std::uint8_t> item(testing::Bytes& frame, unsigned id) {
    for (std::size_t at = 4; at + 3 < frame.size(); at += frame[at + 2] + std::size_t{3}) {
      if ((frame[at] << 8 | frame[at + 1]) == static_cast<int>(id))
        return std::span(frame).subspan(at + 3, frame[at + 2]);
    }
    return {};
  }
  static void add_to(std::span<std::uint8_t> number, std::int64_t difference) {
    std::int64_t value = difference;
    for (const std::uint8_t& byte : number) value += std::int64_t{byte} << (8 * (&number.back() - &byte));
    for (auto& byte : number) byte = static_cast<std::uint8_t>(value >> (8 * (&number.back() - &byte)));
  }
  static void seal(testing::Bytes& frame) {
    std::uint8_t sum = 0;
    for (std::size_t i = 1; i + 1 < frame.size(); ++i) sum = static_cast<std::uint8_t>(sum + frame[i]);
    frame.back() = static_cast<std::uint8_t>(-sum);
  }
  /// The recording `times` times in a row, as one drive: counter and time go on.
  std::vector<testing::Bytes> drive(int times) {
    std::vector<testing::Bytes> all;
    for (int k = 0; k < times; ++k) {
      for (testing::Bytes frame : frames_) {
        add_to(item(frame, 0x1020), 100 * k);
        add_to(item(frame, 0x1060), 9600 * k);
        seal(frame);
        all.push_back(std::move(frame));
      }
    }
    return all;
  }
  /// Each message is received when a sample with the right time would have been taken.
  void play(const std::vector<testing::Bytes>& frames) {
    for (const testing::Bytes& frame : frames) {
      if (has_inertia(frame)) now_ += 10'000;
      node_->on_bytes(now_, frame);
    }
    node_->finish();
  }
  void expect_even_stamps(std::size_t samples) {
    ASSERT_EQ(messages().size(), samples);
    for (const imu_t& message : messages()) EXPECT_EQ((message.utime - kStart) % 10'000, 0) << message.sequence;
  }

  std::vector<testing::Bytes> frames_;
};

class GnssMessagesThatAreOld : public RecordedStream, public ::testing::WithParamInterface<int> {};

TEST_P(GnssMessagesThatAreOld, NeverTouchTheClock) {
  auto frames = drive(48);
  for (auto& frame : frames) {
    if (has_inertia(frame)) continue;
    add_to(item(frame, 0x1060), -GetParam());
    seal(frame);
  }
  play(frames);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(count("refused.time"), 0);
  EXPECT_EQ(count("skipped.incomplete"), 48 * 4);
  expect_even_stamps(48u * 96);
}
INSTANTIATE_TEST_SUITE_P(Ticks, GnssMessagesThatAreOld, ::testing::Values(0, 100, 25'000, 1'000'000));

TEST_F(RecordedStream, SamplesThatAreLostBesideAGnssMessageAreCounted) {
  auto frames = drive(48);
  std::vector<testing::Bytes> left;
  int removed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool beside = i > 0 && !has_inertia(frames[i - 1]);
    removed += beside ? 1 : 0;
    if (!beside) left.push_back(frames[i]);
  }
  play(left);
  EXPECT_EQ(removed, 48 * 4);
  EXPECT_EQ(count("lost.packets"), removed);
  EXPECT_EQ(count("samples"), 48 * 96 - removed);
  EXPECT_EQ(messages().back().sequence, 48 * 96 - 1);
}

TEST_F(RecordedStream, ALostGnssMessageIsNoGapInTheSamples) {
  auto frames = drive(2);
  std::erase_if(frames, [](const testing::Bytes& frame) { return !has_inertia(frame); });
  play(frames);
  EXPECT_EQ(count("lost.packets"), 8);
  EXPECT_EQ(messages().back().sequence, 2 * 96 - 1);
}

class SampleTimesThatAreWrong : public RecordedStream, public ::testing::WithParamInterface<int> {};

TEST_P(SampleTimesThatAreWrong, CostTheirSamplesAndMoveNoStamp) {
  auto frames = drive(5);
  int wrong = 0;
  for (std::size_t i = 20; i + 2 < frames.size(); i += 50) {
    if (!has_inertia(frames[i])) continue;
    add_to(item(frames[i], 0x1060), GetParam());
    seal(frames[i]);
    ++wrong;
  }
  play(frames);
  EXPECT_EQ(count("refused.time"), wrong);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_EQ(count("lost.packets"), 0);
  expect_even_stamps(static_cast<std::size_t>(5 * 96 - wrong));
  EXPECT_EQ(messages().back().sequence, 5 * 96 - 1) << "the gap shows what is missing";
}
INSTANTIATE_TEST_SUITE_P(Ticks, SampleTimesThatAreWrong,
                         ::testing::Values(20'000, -20'000, 36'000'000, -36'000'000, 8, -8, 64, -64));

TEST_F(RecordedStream, SwappedNeighboursCostTheLaterOneAndAreNotLostToo) {
  auto frames = drive(2);
  for (const std::size_t i : {20u, 30u, 31u, 60u, 150u}) std::swap(frames[i], frames[i + 1]);
  play(frames);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(count("refused.time"), 0);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_GE(count("refused.late"), 4);
  EXPECT_EQ(messages().size() + static_cast<std::size_t>(count("refused.late")), 2u * 96);
  EXPECT_EQ(messages().back().sequence, 2 * 96 - 1);
}

TEST_F(RecordedStream, AMessageThatComesTwiceIsUsedOnce) {
  auto frames = drive(1);
  frames.insert(frames.begin() + 50, frames[50]);
  frames.insert(frames.begin() + 10, frames[10]);
  play(frames);
  EXPECT_EQ(count("refused.repeated"), 2);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(messages().size(), 96u);
}

TEST_F(ImuNodeTest, RecordedStreamsOfRealDevicesArePublishedWhole) {
  const std::string file = CURBSTONE_DATA_DIR "/imu_xsens/1.output.bin";
  const testing::Bytes bytes = testing::read_bytes(file);
  if (bytes.empty()) GTEST_SKIP() << file << " is not there";
  ImuConfig config;
  config.configure = false;
  make_node(config);
  std::span<const std::uint8_t> rest = bytes;
  for (; !rest.empty(); now_ += 10'000) {  // a message at a time, at the pace of the device
    const std::size_t size = rest[3] + std::size_t{5};
    node_->on_bytes(now_, rest.first(size));
    rest = rest.subspan(size);
  }
  EXPECT_EQ(count("frames"), 100);
  EXPECT_EQ(count("skipped.incomplete"), 4);  // of its GNSS receiver
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_EQ(messages().size(), 96u);
  for (std::size_t i = 0; i < messages().size(); ++i) EXPECT_EQ(messages()[i].sequence, static_cast<int>(i));
}

}  // namespace
}  // namespace curbstone::imu
