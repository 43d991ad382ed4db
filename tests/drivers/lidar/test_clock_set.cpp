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
  bench.node.finish();
  EXPECT_EQ(bench.count("lost.packets"), 0);
}
INSTANTIATE_TEST_SUITE_P(By, LidarOnASetClock, ::testing::Values(-3600, -1, -0.5, -0.05, 0.06, 0.5, 1, 5, 3600));

/// The device's second is longer or shorter than the host's: `part` of it.
class LidarWhoseClockDrifts : public ::testing::TestWithParam<double> {};

TEST_P(LidarWhoseClockDrifts, IsCorrectedAndNamed) {
  LidarConfig config;
  config.model = models::ModelName::kRs16;
  Bench bench(config);
  bench.host_is_synchronised = false;
  LidarStream stream(std::make_unique<simulate::devices::Rs16Emulator>());
  std::vector<RecordedPacket> packets;
  stream.run_for(20'000'000, packets);
  const std::int64_t begin = packets.front().received;
  for (const RecordedPacket& packet : packets) {
    const auto passed = static_cast<double>(packet.received - begin);
    const std::int64_t now = begin + std::llround(passed * (1 + GetParam()));
    const std::size_t before = bench.points.size();
    bench.send(packet.bytes, now, packet.port);
    bench.node.tick(now);
    if (passed < 7e6 || bench.points.size() == before) continue;
    ASSERT_NEAR(static_cast<double>(now - bench.points.back().utime), 1'333 + 150, 200) << passed * 1e-6 << " s";
  }
  EXPECT_NEAR(static_cast<double>(bench.count("clock.drift_ppm")), GetParam() * 1e6,
              std::abs(GetParam()) < 1e-4 ? 100 : std::abs(GetParam()) * 2e4 + 2);
  const bool named = std::ranges::any_of(bench.node.report().faults, [](const std::string& fault) {
    return fault.find(GetParam() > 0 ? "loses" : "gains") != std::string::npos;
  });
  EXPECT_EQ(named, std::abs(GetParam()) > 5e-4);
}
INSTANTIATE_TEST_SUITE_P(By, LidarWhoseClockDrifts,
                         ::testing::Values(-0.01, -0.001, -0.0002, -0.00002, 0.00002, 0.0002, 0.001, 0.01));

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
