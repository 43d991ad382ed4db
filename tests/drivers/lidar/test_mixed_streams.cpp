// What comes for long beside a device's own packets: each of them twice, another model's, another device's
// information.
#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/drivers/lidar/lidar_stream.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/helios_emulator.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"
#include "tools/simulate/devices/vlp16_emulator.hpp"

namespace curbstone::lidar {
namespace {

using test::kSecond;
using ::testing::Contains;
using ::testing::HasSubstr;

std::unique_ptr<simulate::devices::Rs16Emulator> rs16_at_600(double elevations_off = 0) {
  simulate::devices::Rs16EmulatorConfig config;
  config.rpm = 600;
  for (auto& elevation : config.elevations) elevation += elevations_off;
  return std::make_unique<simulate::devices::Rs16Emulator>(config);
}

/// A driver of an RS16, and one who looks at its status each 50 ms, as its process does.
class MixedStreams : public ::testing::Test {
 protected:
  static std::vector<RecordedPacket> run(LidarStream& stream, std::int64_t us) {
    std::vector<RecordedPacket> packets;
    stream.run_for(us, packets);
    return packets;
  }
  void feed(std::vector<RecordedPacket> packets) {
    std::ranges::stable_sort(packets, {}, &RecordedPacket::received);
    for (const RecordedPacket& packet : packets) {
      if (next_tick_ == 0) next_tick_ = packet.received;
      for (; packet.received >= next_tick_; next_tick_ += 50'000) bench_.node.tick(next_tick_);
      bench_.send(packet.bytes, packet.received, packet.port);
    }
  }
  [[nodiscard]] std::vector<std::string> faults() const { return bench_.node.report().faults; }
  [[nodiscard]] std::string counters() const {
    std::string text;
    const NodeReport report = bench_.node.report();
    for (const auto& [name, value] : report.counters.values()) text += name + " " + std::to_string(value) + "\n";
    return text;
  }
  static LidarConfig config() {
    LidarConfig config;
    config.model = models::ModelName::kRs16;
    return config;
  }

  LidarStream stream_{rs16_at_600()};
  Bench bench_{config()};
  std::int64_t next_tick_ = 0;
};

TEST_F(MixedStreams, EachPacketTwiceForLongIsUsedOnceAndNamed) {
  feed(run(stream_, 4 * kSecond));
  const std::size_t before = bench_.points.size();
  for (int second = 0; second < 15; ++second) {
    auto packets = run(stream_, kSecond);
    const std::size_t sent = packets.size();
    for (std::size_t i = 0; i < sent; ++i) {
      packets.push_back(packets[i]);
      packets.back().received += 40 + 7 * static_cast<std::int64_t>(i % 300);  // up to two packets later
    }
    feed(std::move(packets));
  }
  EXPECT_NEAR(static_cast<double>(bench_.points.size() - before), 15 * 750.75, 5) << counters();
  EXPECT_THAT(faults(), Contains(HasSubstr("most of them refused.duplicate"))) << counters();
  EXPECT_EQ(bench_.count("lost.packets"), 0) << counters();
  stream_.expect_true(bench_.points);
}

TEST_F(MixedStreams, AnotherModelOnThePortIsRefusedByNameAndCostsNothing) {
  feed(run(stream_, 4 * kSecond));
  const std::size_t before = bench_.points.size();
  LidarStream vlp16(
      std::make_unique<simulate::devices::Vlp16Emulator>(simulate::devices::Vlp16EmulatorConfig{.rpm = 600}));
  LidarStream helios(std::make_unique<simulate::devices::HeliosEmulator>(
      simulate::devices::HeliosEmulatorConfig{.lasers = 32, .rpm = 600, .angles = {}}));
  (void)run(vlp16, 4 * kSecond);
  (void)run(helios, 4 * kSecond);
  for (int second = 0; second < 10; ++second) {
    auto packets = run(stream_, kSecond);
    for (LidarStream* other : {&vlp16, &helios}) {
      for (RecordedPacket& packet : run(*other, kSecond)) {
        packet.port = packets.front().port;
        packets.push_back(std::move(packet));
      }
    }
    feed(std::move(packets));
  }
  EXPECT_NEAR(static_cast<double>(bench_.points.size() - before), 10 * 750.75, 4) << counters();
  EXPECT_GT(bench_.count("refused.vlp16"), 5'000) << counters();
  EXPECT_GT(bench_.count("refused.helios32") + bench_.count("refused.helios"), 5'000) << counters();
  EXPECT_THAT(faults(), Contains(HasSubstr("% of the packets of a second were refused")));
  stream_.expect_true(bench_.points);
}

/// As they are delivered, all devices of a maker have one address.
TEST_F(MixedStreams, ASecondDeviceWithTheSameAddressIsNamedAndNotFollowed) {
  feed(run(stream_, 2 * kSecond));
  LidarStream second(rs16_at_600(), [](std::int64_t) { return 588.0; });
  (void)run(second, 2 * kSecond + 617);
  for (int i = 0; i < 10; ++i) {
    auto packets = run(stream_, kSecond);
    // For 50 ms of each second the first one is not heard.
    packets.erase(packets.begin() + 300, packets.begin() + 337);
    for (RecordedPacket& packet : run(second, kSecond)) {
      if (packet.port == stream_.device().table().point_port) packets.push_back(std::move(packet));
    }
    feed(std::move(packets));
  }
  EXPECT_NEAR(static_cast<double>(bench_.points.size()), 2 * 750.75 + 10 * 713, 20) << counters();
  EXPECT_THAT(faults(), Contains(HasSubstr("most of them refused.other_device"))) << counters();
  stream_.expect_true(bench_.points);
}

/// What a device of the same kind said of itself, as one that shares only the port of its information does, is not true
/// of the one whose points come.
TEST_F(MixedStreams, WhatAnotherDeviceSaidBeforeIsForgotten) {
  const auto other = rs16_at_600(0.5);
  for (int i = 0; i < 3; ++i) {
    const std::int64_t at = LidarStream::kStart - (3 - i) * 100'000;
    bench_.send(other->info(at), at, stream_.device().table().info_port);
  }
  bench_.node.forget_device();
  feed(run(stream_, 4 * kSecond));
  EXPECT_GT(bench_.points.size(), 3 * 750U) << counters();
  stream_.expect_true(bench_.points);
}

/// Where no addresses tell them apart, as in a log: two in a row that agree would be believed, and they never agree.
TEST_F(MixedStreams, InformationOfAnotherDeviceOfItsKindChangesNoPoint) {
  feed(run(stream_, 4 * kSecond));
  const auto other = rs16_at_600(0.5);
  for (int second = 0; second < 10; ++second) {
    auto packets = run(stream_, kSecond);
    const std::int64_t at = packets.front().received + 500'000;
    packets.push_back({at, stream_.device().table().info_port, other->info(at)});
    feed(std::move(packets));
  }
  EXPECT_GT(bench_.points.size(), 13 * 750U) << counters();
  stream_.expect_true(bench_.points);
}

}  // namespace
}  // namespace curbstone::lidar
