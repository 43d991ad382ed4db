// The host's clock is set while the LiDAR turns: a moment is lost, and the stamps follow.
#include <gmock/gmock.h>

#include "tests/drivers/lidar/lidar_stream.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"

namespace curbstone::lidar {
namespace {

class LidarOnASetClock : public ::testing::TestWithParam<double> {};

/// Forward it was the old clock's for 5 s more, when IMU and wheels had followed.
TEST_P(LidarOnASetClock, LosesAMomentAndFollows) {
  LidarConfig config;
  config.model = models::ModelName::kRs16;
  config.clock = decoding::ClockMode::kHost;
  Bench bench(config);
  LidarStream stream(std::make_unique<simulate::devices::Rs16Emulator>());
  std::vector<RecordedPacket> packets;
  stream.run_for(16'000'000, packets);
  const std::int64_t begin = packets.front().received;
  const auto step = std::llround(GetParam() * 1e6);
  bool notified = false;
  std::int64_t ticked = 0;
  std::vector<std::int64_t> off;  // us, by which stamps are off, of packets after the step
  for (const RecordedPacket& packet : packets) {
    const bool after = packet.received - begin >= 8'000'000;
    const std::int64_t now = packet.received + (after ? step : 0);
    const std::size_t before = bench.points.size();
    bench.send(packet.bytes, now, packet.port);
    if (packet.received - ticked >= 20'000) {
      ticked = packet.received;
      if (after && !notified) bench.node.clock_was_set(step);
      notified = after;
      bench.node.tick(now);
    }
    if (after && bench.points.size() > before) off.push_back(bench.points.back().utime + 1'333 + 150 - now);
  }
  EXPECT_GE(off.size(), 8U * 750 - 150);
  for (std::size_t i = 100; i < off.size(); ++i) ASSERT_LT(std::abs(off[i]), 3'000) << i;
}
INSTANTIATE_TEST_SUITE_P(By, LidarOnASetClock, ::testing::Values(-3600, -1, -0.5, -0.05, 0.06, 0.5, 1, 3600));

/// Set back by an hour, what was lost counted for nothing for an hour: it waited behind the losses of later times.
TEST(LostPackets, CountWhenTheClockIsSetBack) {
  LostPackets lost;
  lost.add(3'600'000'000, 3);
  EXPECT_EQ(lost.total(), 0) << "they may be late";
  lost.add(1'000'000, 2);
  EXPECT_EQ(lost.total(), 3);
  lost.add(1'000'000 + LostPackets::kSettled, 0);
  EXPECT_EQ(lost.total(), 5);
}

}  // namespace
}  // namespace curbstone::lidar
