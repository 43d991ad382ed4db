#include "drivers/lidar/lidar_node.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <random>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/models/rs16/device_info.hpp"
#include "drivers/lidar/packet_feed.hpp"
#include "drivers/lidar/sources/pcap_source.hpp"
#include "tests/drivers/lidar/bench.hpp"
#include "tests/drivers/lidar/packets.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"

namespace curbstone::lidar {
namespace {

using testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsEmpty;

using test::kStart;
constexpr std::int64_t kPacket = 1332;

TEST(LidarNode, SendsOneMessageAPacketWithItsTimeAndPlaceInTheSequence) {
  Bench bench;
  const auto packets = drive_packets(kStart, 100);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    bench.send(packets[i], kStart + static_cast<std::int64_t>(i + 1) * kPacket + 150);
  }
  ASSERT_EQ(bench.points.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(bench.points[i].utime, kStart + static_cast<std::int64_t>(i) * kPacket);  // the device's own stamp
    EXPECT_EQ(bench.points[i].packet, static_cast<int>(i));
    EXPECT_EQ(bench.points[i].num_points, 384);
    const double turned = static_cast<double>(i) * 24 * 7200 * models::rs16::kSequencePeriod;
    EXPECT_EQ(bench.points[i].revolution, static_cast<int>(turned + 180 + 1e-9) / 360) << i;
  }
  EXPECT_EQ(bench.count("packets"), 100);
  EXPECT_EQ(bench.count("points"), 38400);
  EXPECT_EQ(bench.count("lost.packets"), 0);
  EXPECT_EQ(bench.count("clock.device"), 1);
}

TEST(LidarNode, UsesTheDevicesOwnAnglesOnceItKnowsThem) {
  Bench bench;
  const auto packets = drive_packets(kStart, 3);
  bench.send(packets[0], kStart + kPacket);
  bench.send(packets[1], kStart + 2 * kPacket);
  for (int i = 0; i < 2; ++i)
    bench.send(simulate::devices::Rs16Emulator().difop(kStart, 1200), kStart + kPacket, models::robosense::kDifopPort);
  bench.send(packets[2], kStart + 3 * kPacket);
  EXPECT_FLOAT_EQ(bench.points.at(0).z.at(0), static_cast<float>(10.0 * std::sin(-15.0 * M_PI / 180)));
  EXPECT_FLOAT_EQ(bench.points.at(2).z.at(0), static_cast<float>(10.0 * std::sin(-15.0031 * M_PI / 180)));
  EXPECT_EQ(bench.count("difop"), 2);
}

TEST(LidarNode, CountsWhatWasLost) {
  Bench bench;
  const auto packets = drive_packets(kStart, 300);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (i == 30 || (i >= 100 && i < 150)) continue;
    bench.send(packets[i], kStart + static_cast<std::int64_t>(i + 1) * kPacket);
  }
  EXPECT_EQ(bench.count("lost.packets"), 51);
  EXPECT_EQ(bench.points.back().revolution, static_cast<int>(299 * 24 * 0.3996 + 180) / 360);
}

TEST(LidarNode, RefusesByCauseAndGoesOn) {
  Bench bench;
  auto packets = drive_packets(kStart, 3);
  bench.send(packets[0], kStart + kPacket);
  bench.send({packets[1].data(), 1247}, kStart + kPacket);
  bench.send({}, kStart + kPacket);
  models::rs16::Rs16Packet bad = packets[1];
  bad[0] = 0;
  bench.send(bad, kStart + kPacket);
  bad = packets[1];
  bad[42] = 0;
  bench.send(bad, kStart + kPacket);
  bench.send(packets[1], kStart + 2 * kPacket);
  bench.send(packets[1], kStart + 2 * kPacket);
  bench.send(packets[0], kStart + 2 * kPacket);
  bench.send(packets[2], kStart + 3 * kPacket);
  EXPECT_EQ(bench.count("refused.length"), 2);
  EXPECT_EQ(bench.count("refused.magic"), 1);
  EXPECT_EQ(bench.count("refused.block"), 1);
  EXPECT_EQ(bench.count("refused.duplicate"), 1);
  EXPECT_EQ(bench.count("refused.late"), 1);
  EXPECT_EQ(bench.points.size(), 3U);
  EXPECT_EQ(bench.points.back().packet, 2);
}

TEST(LidarNode, StampsByTheHostWhereTheDevicesClockWasNeverSet) {
  Bench bench;
  const std::int64_t device = 1'483'228'800'000'000;  // 2017-01-01
  const auto packets = drive_packets(device, 750);
  std::mt19937 random(1);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const auto sent = kStart + static_cast<std::int64_t>(i + 1) * kPacket;
    bench.send(packets[i], sent + 60 + static_cast<std::int64_t>(random() % 3000));
  }
  EXPECT_EQ(bench.count("clock.device"), 0);
  for (std::size_t i = 400; i < packets.size(); ++i) {
    const std::int64_t error = bench.points[i].utime - (kStart + static_cast<std::int64_t>(i) * kPacket);
    EXPECT_TRUE(error >= 60 && error < 100) << error;  // the least delay, without its jitter
  }
}

TEST(LidarNode, DoesNotFlapBetweenTheClocks) {
  Bench bench;
  const auto packets = drive_packets(kStart, 3000);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const bool late = (i < 2000 && i % 500 >= 200 && i % 500 < 300) ||
                      i >= 2000;  // again and again a hiccup of the host, then for good
    bench.send(packets[i], kStart + static_cast<std::int64_t>(i + 1) * kPacket + (late ? 1'500'000 : 100));
    ASSERT_EQ(bench.count("clock.device"), i < 2000 + 749 ? 1 : 0) << i;
  }
  EXPECT_EQ(bench.count("clock.switches"), 1);
}

TEST(LidarNode, SaysWhatIsWrongAndRecovers) {
  Bench bench;
  const auto packets = drive_packets(kStart, 6);
  std::int64_t now = kStart;
  const auto run_until = [&](std::int64_t end) {
    for (; now <= end; now += 20'000) bench.node.tick(now);
  };
  run_until(kStart);
  EXPECT_THAT(bench.node.report().faults, IsEmpty());
  run_until(kStart + 1'000'000);
  EXPECT_THAT(bench.node.report().faults, ElementsAre("no packets for 1.0 s on port 6699"));
  models::rs16::Rs16Packet helios = packets[0];
  helios[3] = 0x5A;
  bench.send(helios, kStart);
  run_until(kStart + 1'500'000);
  EXPECT_THAT(bench.node.report().faults, ElementsAre(HasSubstr("a RoboSense Helios is sending; model is rs16")));
  bench.send(packets[0], kStart);
  bench.send(packets[1], kStart);
  run_until(kStart + 2'000'000);
  EXPECT_THAT(bench.node.report().faults, IsEmpty());
  for (std::size_t i = 2; i < 6; ++i) {
    bench.send(packets[i], kStart);
    run_until(kStart + 2'000'000 + static_cast<std::int64_t>(i - 1) * 700'000);
  }
  run_until(kStart + 5'000'000);
  EXPECT_THAT(bench.node.report().faults, ElementsAre("no device information on port 7788: nominal angles are used"));
}

TEST(LidarNode, SendsRawPacketsOnRequestAndRunsAgainFromThem) {
  LidarConfig config;
  Bench silent(config);
  config.publish_raw = true;
  Bench bench(config);
  const auto packets = drive_packets(kStart, 5);
  for (const models::rs16::Rs16Packet& packet : packets) bench.send(packet, kStart + 2000);
  bench.send(simulate::devices::Rs16Emulator().difop(kStart, 1200), kStart, models::robosense::kDifopPort);
  ASSERT_EQ(bench.raw.size(), 6U);
  EXPECT_THAT(bench.raw[3].data, testing::ElementsAreArray(packets[3]));
  EXPECT_EQ(bench.raw[5].port, models::robosense::kDifopPort);
  for (const raw_packet_t& raw : bench.raw) silent.node.on(raw);
  silent.bus.dispatch();
  EXPECT_EQ(silent.points.size(), bench.points.size());
  EXPECT_EQ(silent.points.at(4).x, bench.points.at(4).x);
  EXPECT_THAT(silent.raw, IsEmpty());
}

TEST(LidarNode, SurvivesAnyBytes) {
  Bench bench;
  std::mt19937 random(5);
  const auto packets = drive_packets(kStart, 200);
  const models::rs16::Rs16Packet info = simulate::devices::Rs16Emulator().difop(kStart, 1200);
  for (int i = 0; i < 5000; ++i) {
    const auto& source = i % 7 == 0 ? info : packets[random() % packets.size()];
    std::vector<std::uint8_t> bytes(source.begin(), source.end());
    if (i % 5 == 0) bytes.resize(random() % 2000);
    for (auto k = random() % 60; k > 0 && !bytes.empty(); --k)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bench.send(bytes, kStart + static_cast<std::int64_t>(random()) - 2'000'000'000);
    bench.node.tick(kStart + i * 20'000);
    ASSERT_LE(bench.node.report().faults.size(), 4U);
  }
  for (const lidar_points_t& message : bench.points) {
    ASSERT_LE(message.num_points, 384);
    ASSERT_TRUE(std::ranges::all_of(message.x, [](float x) { return std::isfinite(x); }));
  }
}

class Recorded : public testing::Test {
 protected:
  static LidarConfig capture(const std::string& name) {
    LidarConfig config;
    config.pcap = test::data_path("rs16/") + name;
    return config;
  }
  void SetUp() override {
    const std::string folder = test::data_path("rs16");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  }
};

TEST_F(Recorded, WashingHouseIsReadWhole) {
  const LidarConfig config = capture("rs16_washing_house.pcap");
  Bench bench(config);
  EXPECT_EQ(feed_whole_capture(config, bench.node), 3040);
  bench.bus.dispatch();
  EXPECT_EQ(bench.count("packets"), 3000);
  EXPECT_EQ(bench.count("difop"), 40);
  EXPECT_EQ(bench.count("lost.packets"), 0);
  const NodeReport report = bench.node.report();
  for (const auto& [name, value] : report.counters.values()) {
    EXPECT_FALSE(name.starts_with("refused")) << name << " " << value;
  }
  // 4.0 s at 600 rpm: forty whole revolutions, in forty-one pieces, as the capture starts in mid-turn.
  EXPECT_EQ(bench.points.back().revolution - bench.points.front().revolution, 40);
  // 92 % of the records have a return; the median is 3.1 m (data/README.md).
  std::vector<float> ranges;
  for (const lidar_points_t& m : bench.points)
    for (std::size_t i = 0; i < m.x.size(); ++i) ranges.push_back(std::hypot(m.x[i], m.y[i], m.z[i]));
  std::ranges::nth_element(ranges, ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2));
  EXPECT_NEAR(ranges[ranges.size() / 2], 3.1, 0.1);
  EXPECT_NEAR(static_cast<double>(ranges.size()) / (3000 * 384), 0.92, 0.02);
  // The clock was never set: times of capture are used, and rise without jitter.
  EXPECT_EQ(bench.count("clock.device"), 0);
  for (std::size_t i = 1500; i < bench.points.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(bench.points[i].utime - bench.points[i - 1].utime), 1333.25, 10.0) << i;
  }
}

TEST_F(Recorded, WashingHouseGivesItsAngles) {
  sources::PcapSource source(test::data_path("rs16/rs16_washing_house.pcap"));
  for (auto packet = source.next(); packet; packet = source.next()) {
    if (packet->port != models::robosense::kDifopPort) continue;
    const models::rs16::DifopResult result = models::rs16::parse_difop(packet->bytes);
    ASSERT_EQ(result.refusal, decoding::Refusal::kNone);
    EXPECT_TRUE(result.info.calibrated);
    EXPECT_DOUBLE_EQ(result.info.elevations[0], -15.0094);
    EXPECT_DOUBLE_EQ(result.info.elevations[6], -2.9874);
    EXPECT_DOUBLE_EQ(result.info.elevations[15], 1.0026);
    EXPECT_EQ(result.info.rpm, 600);
    const int called[] = {5000, 3300, 2500, 1200};  // mV
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(result.status.millivolts[i], called[i], 0.025 * called[i]);
    EXPECT_EQ(result.info.distance_step, 0.005);
    EXPECT_FALSE(result.info.dual_return);
  }
}

TEST_F(Recorded, AHeliosIsRefusedByName) {
  const LidarConfig config = capture("helios16p.pcap");
  Bench bench(config);
  EXPECT_EQ(feed_whole_capture(config, bench.node), 751);
  bench.bus.dispatch();
  EXPECT_THAT(bench.points, IsEmpty());
  EXPECT_EQ(bench.count("refused.helios32"), 750);
  EXPECT_EQ(bench.count("refused.helios"), 1) << "its device information, which does not tell the lasers";
  EXPECT_EQ(bench.count("difop"), 0);
}

}  // namespace
}  // namespace curbstone::lidar
