#include "drivers/lidar/sources/pcap_source.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <random>

#include "drivers/lidar/sources/udp_frame.hpp"
#include "tests/drivers/lidar/captures.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

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

/// A pcapng file written block by block.
class Blocks {
 public:
  explicit Blocks(bool big_endian = false) : big_endian_(big_endian) {
    block(0x0A0D0D0A, words({0x1A2B3C4D, 0x00010000, 0xFFFFFFFF, 0xFFFFFFFF}));
  }
  void interface(std::uint32_t link, const Bytes& options = {}) {
    const Bytes type = big_endian_ ? words({link << 16}) : words({link});
    block(1, type + words({0}) + options);
  }
  void packet(std::uint32_t interface, std::uint64_t stamp, const Bytes& f) {
    const auto size = static_cast<std::uint32_t>(f.size());
    block(
        6,
        words({interface, static_cast<std::uint32_t>(stamp >> 32), static_cast<std::uint32_t>(stamp), size, size}) + f);
  }
  void block(std::uint32_t type, Bytes body) {
    body.resize((body.size() + 3) / 4 * 4);
    const auto length = static_cast<std::uint32_t>(body.size() + 12);
    bytes_ = bytes_ + words({type, length}) + body + words({length});
  }
  [[nodiscard]] Bytes words(std::initializer_list<std::uint32_t> values) const {
    Bytes bytes;
    for (const std::uint32_t value : values) {
      for (int i = 0; i < 4; ++i)
        bytes.push_back(static_cast<std::uint8_t>(value >> (big_endian_ ? 24 - 8 * i : 8 * i)));
    }
    return bytes;
  }
  [[nodiscard]] std::string file(std::size_t cut = 0) const {
    std::ofstream out(folder_ / "mixed.pcapng", std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size() - cut));
    return folder_ / "mixed.pcapng";
  }

 private:
  bool big_endian_;
  Bytes bytes_;
  test::TemporaryFolder folder_;
};

TEST(PcapSource, ReadsEachFrameOfAPcapngByTheLinkTypeOfItsOwnInterface) {
  Bytes cooked2(20, 0xAB);
  cooked2[0] = 0x08;
  cooked2[1] = 0x00;
  for (const bool big_endian : {false, true}) {
    Blocks capture(big_endian);
    capture.interface(kEthernet);
    capture.interface(kCooked2);
    capture.interface(kLoopback);
    capture.interface(227);  // CAN: no UDP on it
    capture.interface(kRawIp);
    capture.packet(1, 100'000'001, cooked2 + ip_packet({1}, 6699));
    capture.packet(0, 100'000'002, frame({2}, 6699));
    capture.packet(3, 100'000'003, Bytes(16, 0));
    capture.block(5, capture.words({0, 0, 0}));  // interface statistics
    capture.packet(2, 100'000'004, Bytes{2, 0, 0, 0} + ip_packet({3}, 6699));
    capture.packet(4, 100'000'005, ip_packet({4}, 6699));
    PcapSource source(capture.file());
    for (const int expected : {1, 2, 3, 4}) {
      const auto packet = source.next();
      ASSERT_TRUE(packet) << expected;
      EXPECT_EQ(packet->port, 6699);
      EXPECT_EQ(to_text(packet->sender), "192.168.1.200");
      EXPECT_EQ(packet->received, 100'000'000 + expected + (expected > 2 ? 1 : 0));
      EXPECT_EQ(Bytes(packet->bytes.begin(), packet->bytes.end()), Bytes{static_cast<std::uint8_t>(expected)});
    }
    EXPECT_FALSE(source.next());
    EXPECT_EQ(source.skipped(), (PcapSource::Skipped{.other_link = 1}));
  }
}

TEST(PcapSource, ReadsThePcapngUnitsOfTimeOfEachInterface) {
  Blocks capture;
  capture.interface(kEthernet, {9, 0, 1, 0, 9, 0, 0, 0, 0, 0, 0, 0});                    // ns
  capture.interface(kEthernet, {9, 0, 1, 0, 0x80 + 20, 0, 0, 0});                        // 2^-20 s
  capture.interface(kEthernet, {14, 0, 8, 0, 60, 0, 0, 0, 0, 0, 0, 0});                  // 60 s later
  capture.interface(kEthernet, {9, 0, 1, 0, 3, 0, 0, 0, 2, 0, 3, 0, 'e', 't', 'h', 0});  // ms
  capture.packet(0, 100'000'000'123'456'789, frame({1}, 1));
  capture.packet(1, (std::uint64_t{100} << 20) + (1 << 19), frame({1}, 1));
  capture.packet(2, 100'000'042, frame({1}, 1));
  capture.packet(3, 100'042, frame({1}, 1));
  PcapSource source(capture.file());
  for (const std::int64_t expected :
       std::vector<std::int64_t>{100'000'000'123'456, 100'500'000, 160'000'042, 100'042'000})
    EXPECT_EQ(source.next()->received, expected);
}

TEST(PcapSource, SaysWhatIsWrongWithAPcapng) {
  const auto first_error_of = [](const Blocks& capture, std::size_t cut = 0) -> std::string {
    try {
      PcapSource source(capture.file(cut));
      while (source.next()) {
      }
      return {};
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  Blocks capture;
  capture.interface(227);
  EXPECT_THAT(first_error_of(capture), HasSubstr("link type"));
  capture.interface(kEthernet);
  capture.packet(1, 100'000'000, frame({1}, 1));
  EXPECT_EQ(first_error_of(capture), "");
  EXPECT_THAT(first_error_of(capture, 2), HasSubstr("truncated"));
  EXPECT_THAT(first_error_of(capture, 50), HasSubstr("truncated"));
  capture.packet(7, 100'000'000, frame({1}, 1));
  EXPECT_THAT(first_error_of(capture), HasSubstr("damaged: a packet of interface 7"));
  Blocks long_packet;
  long_packet.interface(kEthernet);
  long_packet.block(6, long_packet.words({0, 0, 0, 100, 100, 0}));
  EXPECT_THAT(first_error_of(long_packet), HasSubstr("damaged: a packet longer than its block"));
}

/// For the sanitizers.
TEST(PcapSource, LivesWithAnyPcapng) {
  Blocks whole;
  whole.interface(kEthernet, {9, 0, 1, 0, 9, 0, 0, 0});
  whole.interface(kCooked2);
  for (int i = 0; i < 4; ++i) whole.packet(0, 100'000'000, frame({1, 2, 3}, 6699));
  const std::string file = whole.file();
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    std::string damaged = bytes;
    for (auto k = random() % 4 + 1; k > 0; --k)
      damaged[8 + random() % (damaged.size() - 8)] = static_cast<char>(random());
    std::ofstream(file, std::ios::binary) << damaged;
    try {
      PcapSource source(file);
      for (int n = 0; n < 100 && source.next(); ++n) {
      }
    } catch (const std::runtime_error&) {
    }
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
              ThrowsMessage<std::runtime_error>(HasSubstr("README.md: not a capture: unknown file format")));
  const test::TemporaryFolder folder;
  const std::string compressed = folder / "drive.pcap.gz";
  std::ofstream(compressed, std::ios::binary) << "\x1F\x8B\x08";
  EXPECT_THAT([&] { PcapSource{compressed}; },
              ThrowsMessage<std::runtime_error>(HasSubstr("not a capture, but a file compressed by gzip")));
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
