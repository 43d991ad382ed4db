#include "drivers/lidar/sources/pcap_source.hpp"

#include <gmock/gmock.h>

#include <random>

#include "drivers/lidar/sources/udp_frame.hpp"
#include "tests/drivers/lidar/captures.hpp"
#include "tests/paths.hpp"

namespace curbstone::lidar::sources {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
TEST(PcapSource, ReadsPayloadPortAndTimeWithAndWithoutVlan) {
  const Capture capture({frame({1, 2, 3}, 6699), frame({4}, 7788, 1), frame({5}, 9, 2)});
  PcapSource source(capture.name());
  for (const auto& [port, payload, second] :
       {std::tuple{6699, Bytes{1, 2, 3}, 100}, {7788, Bytes{4}, 101}, {9, Bytes{5}, 102}}) {
    const auto packet = source.next();
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->port, port);
    EXPECT_EQ(packet->received, second * 1'000'000LL + 42);
    EXPECT_EQ(Bytes(packet->bytes.begin(), packet->bytes.end()), payload);
  }
  EXPECT_FALSE(source.next());
  EXPECT_FALSE(source.next());
}

TEST(PcapSource, ReadsStampsInNanosecondsAndPcapng) {
  for (const Capture::Format format : {Capture::Format::kNanoseconds, Capture::Format::kPcapng}) {
    const Capture capture({frame({1, 2, 3}, 6699), frame({4, 5}, 7788)}, kEthernet, format);
    PcapSource source(capture.name());
    EXPECT_EQ(source.next()->received, 100'000'042);
    const auto packet = source.next();
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->received, 101'000'042);
    EXPECT_EQ(packet->port, 7788);
    EXPECT_FALSE(source.next());
  }
}

TEST(PcapSource, ReadsEachLinkTypeWithTheSender) {
  Bytes cooked(14, 0xAB), cooked2(20, 0xAB), cooked2_vlan(20, 0xAB);
  put(cooked, {0x08, 0x00});
  cooked2[0] = 0x08;
  cooked2[1] = 0x00;
  cooked2_vlan[0] = 0x81;
  cooked2_vlan[1] = 0x00;
  put(cooked2_vlan, {0x00, 0x05, 0x08, 0x00});
  const Bytes ip = ip_packet({7, 8}, 6699, 201);
  const Bytes little_end = {2, 0, 0, 0}, big_end = {0, 0, 0, 2};  // the family of IPv4
  for (const auto& [head, link] : {std::pair{Bytes(), kRawIp},
                                   {cooked, kCooked},
                                   {cooked2, kCooked2},
                                   {cooked2_vlan, kCooked2},
                                   {little_end, kLoopback},
                                   {big_end, kLoopback}}) {
    const Capture capture({head + ip}, link);
    PcapSource source(capture.name());
    const auto packet = source.next();
    ASSERT_TRUE(packet) << link;
    EXPECT_EQ(packet->port, 6699);
    EXPECT_EQ(to_text(packet->sender), "192.168.1.201");
    EXPECT_EQ(Bytes(packet->bytes.begin(), packet->bytes.end()), (Bytes{7, 8}));
  }
}

TEST(PcapSource, CountsWhatIsNoWholeUdpPacketByCause) {
  Bytes arp = frame({}, 1);
  arp[12] = 0x08;
  arp[13] = 0x06;
  Bytes tcp = frame({1}, 1);
  tcp[23] = 6;
  Bytes first_fragment = frame({1}, 1), last_fragment = frame({1}, 1);
  first_fragment[20] = 0x20;
  last_fragment[21] = 0xB9;
  Bytes cut = frame({1, 2, 3, 4}, 1);
  cut.pop_back();
  const Capture capture({arp, tcp, first_fragment, last_fragment, cut, {}, {1, 2, 3}, frame({9}, 5)});
  PcapSource source(capture.name());
  const auto packet = source.next();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->port, 5);
  EXPECT_EQ(source.skipped(), (PcapSource::Skipped{.not_udp = 2, .fragments = 2, .cut = 3}));
}

TEST(PcapSource, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT([] { PcapSource("/nowhere/drive.pcap"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/drive.pcap: No such file")));
  EXPECT_THAT([] { PcapSource(test::source_path("README.md")); },
              ThrowsMessage<std::runtime_error>(HasSubstr("cannot read the capture")));
  const Capture can({frame({1}, 1)}, 227);
  EXPECT_THAT([&] { PcapSource{can.name()}; }, ThrowsMessage<std::runtime_error>(HasSubstr("link type")));
}

TEST(PcapSource, AFrameOfAnImpossibleTimeIsDamage) {
  const Bytes udp = frame({1, 2, 3}, 6699);
  const Capture capture({udp, udp}, kEthernet, Capture::Format::kPcapng, std::int64_t{1} << 61);
  PcapSource source(capture.name());
  EXPECT_TRUE(source.next());
  EXPECT_THAT([&] { (void)source.next(); }, ThrowsMessage<std::runtime_error>(HasSubstr("damaged")));
}

TEST(PcapSource, TellsACutOffFileFromAWholeOne) {
  const Capture capture({frame({1, 2, 3}, 6699), frame({4, 5, 6}, 6699)});
  capture.cut(2);
  PcapSource source(capture.name());
  EXPECT_TRUE(source.next());
  EXPECT_THAT([&] { (void)source.next(); }, ThrowsMessage<std::runtime_error>(HasSubstr("truncated")));
}

TEST(UdpFrame, NeverReachesBeyondTheFrameWhateverComes) {
  std::mt19937 random(11);
  for (int i = 0; i < 50'000; ++i) {
    Bytes bytes = frame(Bytes(random() % 40), 6699, static_cast<int>(random() % 3));
    for (auto k = random() % 6; k > 0; --k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();
    for (const UdpFrame& udp :
         {udp_in_ethernet(bytes), udp_in_sll(bytes), udp_in_sll2(bytes), udp_in_ip(bytes), udp_in_loopback(bytes)}) {
      if (udp.kind != FrameKind::kUdp) {
        ASSERT_TRUE(udp.payload.empty());
        continue;
      }
      ASSERT_GE(udp.payload.data(), bytes.data());
      ASSERT_LE(udp.payload.data() + udp.payload.size(), bytes.data() + bytes.size());
    }
  }
}

}  // namespace
}  // namespace curbstone::lidar::sources
