#include "drivers/lidar/driver_capture.hpp"

#include <gmock/gmock.h>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/packet_feed.hpp"
#include "tests/drivers/lidar/captures.hpp"
#include "tests/drivers/lidar/packets.hpp"
#include "tests/paths.hpp"

namespace curbstone::lidar {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // us

LidarConfig config_for(const Capture& capture) {
  LidarConfig config;
  config.pcap = capture.name();
  config.msop_port = 6699;
  config.difop_port = 7788;
  return config;
}

std::vector<Bytes> frames_of(const std::vector<models::rs16::Rs16Packet>& packets, int sender = 200) {
  std::vector<Bytes> frames;
  for (const auto& each : packets) frames.push_back(frame(Bytes(each.begin(), each.end()), 6699, 0, sender));
  return frames;
}

TEST(DriverCapture, SaysWhichPortsAFileHasThatHasNoneOfTheDrivers) {
  const Capture capture({frame(Bytes(1206), 2368, 0, 201), frame(Bytes(1206), 2368, 0, 201), frame(Bytes(512), 8308)});
  EXPECT_THAT([&] { DriverCapture(config_for(capture), false); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("no UDP packet to port 6699 or 7788 in it; it has: port 2368 from 192.168.1.201: 2 "
                                  "packets of 1206 bytes; port 8308 from 192.168.1.200: 1 packets of 512 bytes"))));
}

TEST(DriverCapture, SaysWhoSendsInsteadOfTheDevice) {
  const Capture capture({frame(Bytes(1248), 6699, 0, 201)});
  LidarConfig config = config_for(capture);
  config.device_address = "192.168.1.200";
  EXPECT_THAT([&] { DriverCapture(config, false); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("no UDP packet from 192.168.1.200 to port 6699"),
                                                      HasSubstr("port 6699 from 192.168.1.201: 1 packets"))));
}

TEST(DriverCapture, RefusesOtherSendersThanTheDeviceBySource) {
  const auto packets = drive_packets(kBegin, 4);
  std::vector<Bytes> frames = frames_of(packets);
  const std::vector<Bytes> others = frames_of(packets, 201);
  frames.insert(frames.begin() + 1, others.begin(), others.begin() + 3);
  const Capture capture(frames, kEthernet, Capture::Format::kMicroseconds, 1332);
  LidarConfig config = config_for(capture);
  config.device_address = "192.168.1.200";
  LocalBus bus;
  LidarNode node(config, bus);
  EXPECT_EQ(feed_whole_capture(config, node), 4);
  EXPECT_EQ(node.report().counters["packets"], 4);
  EXPECT_EQ(node.report().counters["refused.source"], 3);
}

TEST(DriverCapture, OfTwoSendersTheFirstIsReadAndBothAreNamed) {
  const auto packets = drive_packets(kBegin, 4);
  std::vector<Bytes> frames = frames_of(packets);
  const std::vector<Bytes> others = frames_of(packets, 201);
  frames.insert(frames.begin() + 2, others.begin(), others.begin() + 3);
  const Capture capture(frames, kEthernet, Capture::Format::kMicroseconds, 1332);
  LocalBus bus;
  LidarNode node(config_for(capture), bus);
  EXPECT_EQ(feed_whole_capture(config_for(capture), node), 4);
  EXPECT_EQ(node.report().counters["refused.source"], 3);
  EXPECT_THAT(node.report().faults, ::testing::Contains(HasSubstr("two devices send: 192.168.1.200 is read")));
}

TEST(DriverCapture, CountsFragmentsByTheirCause) {
  std::vector<Bytes> frames = frames_of(drive_packets(kBegin, 2));
  Bytes fragment = frames[0];
  fragment[20] = 0x20;
  frames.push_back(fragment);
  const Capture capture(frames);
  LocalBus bus;
  LidarNode node(config_for(capture), bus);
  feed_whole_capture(config_for(capture), node);
  EXPECT_EQ(node.report().counters["refused.fragment"], 1);
}

TEST(DriverCapture, GoesOnByTheCapturesLengthWhenItBeginsAnew) {
  const Capture capture(frames_of(drive_packets(kBegin, 3)), kEthernet, Capture::Format::kMicroseconds, 1332);
  DriverCapture source(config_for(capture), true);
  for (int i = 0; i < 9; ++i) {
    ASSERT_TRUE(source.packet());
    EXPECT_EQ(source.packet()->received, 100'000'042 + i * 1332);
    models::rs16::MsopPacket packet;
    ASSERT_EQ(source.packet()->bytes.size(), sizeof packet);
    std::memcpy(&packet, source.packet()->bytes.data(), sizeof packet);
    EXPECT_EQ(models::robosense::utime_from(packet.time), kBegin + i * 1332);
    source.advance();
  }
  EXPECT_EQ(source.repeats(), 3);
}

TEST(DriverCapture, EndsOnceWithoutRepeat) {
  const Capture capture(frames_of(drive_packets(kBegin, 3)));
  DriverCapture source(config_for(capture), false);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(source.packet());
    source.advance();
  }
  EXPECT_FALSE(source.packet());
}

TEST(DriverCapture, DecodesEachPassOfARecordingAlike) {
  const std::string recorded = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  LidarConfig config;
  config.pcap = recorded;
  config.msop_port = 6699;
  config.difop_port = 7788;
  DriverCapture source(config, true);
  LocalBus bus;
  LidarNode node(config, bus);
  std::int64_t used_first = 0;
  for (; source.repeats() < 2; source.advance()) {
    if (source.repeats() == 1 && used_first == 0) used_first = node.report().counters["packets"];
    node.on_packet(source.packet()->received, source.packet()->port, source.packet()->bytes);
  }
  // At the seam the head is elsewhere than one packet before: this may cost a revolution, no more.
  EXPECT_GT(used_first, 2900);
  EXPECT_GE(node.report().counters["packets"], 2 * used_first - 75);
}

}  // namespace
}  // namespace curbstone::lidar
