#include "drivers/lidar/sources/pcap_source.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "drivers/lidar/sources/udp_frame.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::lidar::sources {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Bytes = std::vector<std::uint8_t>;

void put(Bytes& bytes, std::initializer_list<int> values) {
  for (const int value : values) bytes.push_back(static_cast<std::uint8_t>(value));
}
void put16(Bytes& bytes, std::size_t value) {
  put(bytes, {static_cast<int>(value >> 8), static_cast<int>(value & 0xFF)});
}

/// An Ethernet frame with `payload` in UDP to `port`, behind `tags` VLAN tags.
Bytes frame(const Bytes& payload, int port, int tags = 0) {
  Bytes bytes(12, 0xAB);
  for (int i = 0; i < tags; ++i) put(bytes, {0x81, 0x00, 0x00, 0x05});
  put(bytes, {0x08, 0x00, 0x45, 0x00});
  put16(bytes, 28 + payload.size());
  put(bytes, {0, 1, 0, 0, 64, 17, 0, 0, 192, 168, 1, 200, 192, 168, 1, 102});
  put16(bytes, 6699);
  put16(bytes, static_cast<std::size_t>(port));
  put16(bytes, 8 + payload.size());
  put16(bytes, 0);
  for (const std::uint8_t byte : payload) bytes.push_back(byte);
  return bytes;
}

/// A capture file of its own that goes with the test.
class Capture {
 public:
  explicit Capture(const std::vector<Bytes>& frames, std::uint32_t link_type = 1) {
    put({0xA1B2C3D4, 0x00040002, 0, 0, 65535, link_type});
    std::uint32_t time = 100;
    for (const Bytes& f : frames) {
      const auto size = static_cast<std::uint32_t>(f.size());
      put({time++, 42, size, size});
      file_.write(reinterpret_cast<const char*>(f.data()), static_cast<std::streamsize>(size));
    }
    file_.close();
  }
  ~Capture() { std::filesystem::remove(name_); }
  void cut(std::uintmax_t bytes) const {
    std::filesystem::resize_file(name_, std::filesystem::file_size(name_) - bytes);
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void put(std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words) file_.write(reinterpret_cast<const char*>(&word), sizeof word);
  }
  testing::TemporaryFolder folder_;
  std::string name_ = folder_ / "capture.pcap";
  std::ofstream file_{name_, std::ios::binary};
};

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

TEST(PcapSource, SkipsWhatIsNoWholeUdpPacket) {
  Bytes arp = frame({}, 1);
  arp[12] = 0x08;
  arp[13] = 0x06;
  Bytes tcp = frame({1}, 1);
  tcp[23] = 6;
  Bytes fragment = frame({1}, 1);
  fragment[20] = 0x20;
  Bytes cut = frame({1, 2, 3, 4}, 1);
  cut.pop_back();
  const Capture capture({arp, tcp, fragment, cut, {}, {1, 2, 3}, frame({9}, 5)});
  PcapSource source(capture.name());
  const auto packet = source.next();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->port, 5);
  EXPECT_EQ(source.skipped(), 6);
}

TEST(PcapSource, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT([] { PcapSource("/nowhere/drive.pcap"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/drive.pcap: No such file")));
  EXPECT_THAT([] { PcapSource(CURBSTONE_SOURCE_DIR "/README.md"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("cannot read the capture")));
  const Capture can({frame({1}, 1)}, 227);
  EXPECT_THAT([&] { PcapSource{can.name()}; }, ThrowsMessage<std::runtime_error>(HasSubstr("link type")));
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
    if (const auto udp = udp_in_ethernet(bytes)) {
      ASSERT_GE(udp->payload.data(), bytes.data());
      ASSERT_LE(udp->payload.data() + udp->payload.size(), bytes.data() + bytes.size());
    }
  }
}

}  // namespace
}  // namespace curbstone::lidar::sources
