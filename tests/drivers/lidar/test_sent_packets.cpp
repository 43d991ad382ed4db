// What a listener asks for comes again with every bit, whatever the device has become since.
#include <gmock/gmock.h>
#include <malloc.h>

#include <curbstone/resend_request_t.hpp>
#include <utility>

#include "tests/drivers/lidar/bench.hpp"
#include "tests/drivers/lidar/lidar_stream.hpp"
#include "tools/simulate/devices/make_lidar.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"

namespace curbstone::lidar {
namespace {

using simulate::devices::LidarName;

std::vector<std::uint8_t> encoded(const lidar_points_t& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, message.getEncodedSize());
  return bytes;
}

/// Sends what the stream brings, asks for all of it, and compares.
void expect_all_again(LidarStream& stream, const LidarConfig& config, const std::function<void()>& halfway) {
  Bench bench(config);
  std::vector<lidar_points_t> again;
  bench.bus.subscribe<lidar_points_t>("LIDAR_POINTS_AGAIN", [&](const lidar_points_t& m) { again.push_back(m); });
  for (int half = 0; half < 2; ++half) {
    std::vector<RecordedPacket> packets;
    stream.run_for(3'000'000, packets);
    for (const RecordedPacket& packet : packets) bench.send(packet.bytes, packet.received, packet.port);
    if (half == 0) halfway();
  }
  bench.finish();
  ASSERT_GT(bench.points.size(), 2000U);
  resend_request_t request{};
  request.requester = "mapper";
  request.channel = "LIDAR_POINTS";
  request.before = bench.points.back().utime + 1;
  bench.node.tick(LidarStream::kStart);
  bench.bus.publish("RESEND_REQUEST", request);
  bench.bus.dispatch();
  for (int i = 0; i < 500; ++i) {
    bench.node.tick(LidarStream::kStart + i * 20'000);
    bench.bus.dispatch();
  }
  ASSERT_EQ(again.size(), bench.points.size());
  for (std::size_t i = 0; i < again.size(); ++i) ASSERT_EQ(encoded(again[i]), encoded(bench.points[i])) << i;
}

TEST(SentPackets, ComeAgainBitForBitFromEveryModel) {
  const std::pair<LidarName, models::ModelName> names[] = {{LidarName::kRs16, models::ModelName::kRs16},
                                                           {LidarName::kVlp16, models::ModelName::kVlp16},
                                                           {LidarName::kHelios16p, models::ModelName::kHelios16p},
                                                           {LidarName::kHelios32, models::ModelName::kHelios32}};
  for (const auto& [device, model] : names) {
    LidarStream stream(simulate::devices::make_lidar(device, 600));
    SCOPED_TRACE(std::string(stream.device().table().name));
    LidarConfig config;
    config.model = model;
    expect_all_again(stream, config, [] {});
  }
}

TEST(SentPackets, ComeAgainAsTheDeviceWasThen) {
  using simulate::devices::ReturnMode;
  using simulate::devices::Rs16Emulator;
  LidarStream stream(std::make_unique<Rs16Emulator>(simulate::devices::Rs16EmulatorConfig{.rpm = 600}));
  expect_all_again(stream, {}, [&] {
    stream.become(
        std::make_unique<Rs16Emulator>(simulate::devices::Rs16EmulatorConfig{.rpm = 600, .mode = ReturnMode::kDual}));
  });
}

TEST(SentPackets, OfTenSecondsTakeAThirdOfTheirMessagesAtMost) {
  LidarStream stream(simulate::devices::make_lidar(LidarName::kRs16, 600));
  std::vector<RecordedPacket> packets;
  stream.run_for(12'000'000, packets);
  Bench bench;
  const std::size_t before = mallinfo2().uordblks;
  for (const RecordedPacket& packet : packets) {
    bench.send(packet.bytes, packet.received, packet.port);
    if (bench.points.size() > 1) bench.points.clear();
  }
  constexpr std::size_t kPackets = 7500;
  constexpr std::size_t kMessage = 6900;  // bytes, of 384 points
  EXPECT_LT(mallinfo2().uordblks - before, kPackets * kMessage / 3);
}

}  // namespace
}  // namespace curbstone::lidar
