#include "tools/lidar_tool/info.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "tests/drivers/lidar/captures.hpp"
#include "tests/drivers/lidar/models/helios/helios_packets.hpp"
#include "tests/drivers/lidar/models/other_makers_packets.hpp"
#include "tests/drivers/lidar/packets.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"

namespace curbstone::lidar_tool {
namespace {

using lidar::Bytes;
using lidar::Capture;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

using test::kStart;
constexpr int kPort = 46701;

std::string info_of(const std::string& file) {
  return info_text(*packets_from(file, {}), "capture");
}

std::vector<Bytes> point_frames(int count, int sender = 200) {
  std::vector<Bytes> frames;
  for (const auto& each : lidar::drive_packets(kStart, count))
    frames.push_back(lidar::frame(Bytes(each.begin(), each.end()), 6699, 0, sender));
  return frames;
}

Bytes info_frame() {
  const auto info = simulate::devices::Rs16Emulator().difop(kStart, 1200);
  return lidar::frame(Bytes(info.begin(), info.end()), 7788);
}

TEST(LidarInfo, TellsTheRecordingOfAnRs16) {
  const std::string recorded = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  const std::string text = info_of(recorded);
  EXPECT_THAT(text, HasSubstr("capture: 3040 UDP packets of 1 senders"));
  EXPECT_THAT(text, HasSubstr("RoboSense RS-LiDAR-16 (model: rs16)"));
  EXPECT_THAT(text, HasSubstr("6699: 3000 packets of 1248 bytes"));
  EXPECT_THAT(text, HasSubstr("7788: 40 packets of 1248 bytes"));
  EXPECT_THAT(text, HasSubstr("points    1056856 in 3000 packets"));
  EXPECT_THAT(text, HasSubstr("lost      0 packets"));
  EXPECT_THAT(text, HasSubstr("refused   none"));
  EXPECT_THAT(text, HasSubstr("angles    the device's own"));
}

TEST(LidarInfo, NamesTheDeviceOfTheRecordingThatIsNoRs16) {
  const std::string recorded = test::data_path("rs16/helios16p.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  EXPECT_THAT(info_of(recorded), AllOf(HasSubstr("751 UDP packets"), HasSubstr("Helios"), HasSubstr("32"),
                                       HasSubstr("6699: 750 packets of 1248 bytes")));
}

TEST(LidarInfo, TellsEachSettingThatTheDeviceTells) {
  std::vector<Bytes> frames = point_frames(100);
  frames.insert(frames.begin() + 50, info_frame());
  const Capture capture(frames, lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const std::string text = info_of(capture.name());
  EXPECT_THAT(text, HasSubstr("returns   strongest"));
  EXPECT_THAT(text, HasSubstr("speed     1200.0 rpm (set: 1200)"));
  EXPECT_THAT(text, HasSubstr("angles    the device's own"));
  EXPECT_THAT(text, HasSubstr("clock     device 2023-11-14 22:13:20 UTC"));
  EXPECT_THAT(text, HasSubstr("not set, the host's time is to be used")) << "captured in 1970";
}

TEST(LidarInfo, CountsWhatIsLostAndRefusedByCause) {
  std::vector<Bytes> frames = point_frames(300);
  frames[100][42 + 42] = 0;  // the flag of the first block
  frames.insert(frames.begin() + 200, frames[200]);
  const Capture capture(frames, lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  EXPECT_THAT(info_of(capture.name()), AllOf(HasSubstr("1 refused.block"), HasSubstr("1 refused.duplicate")));
}

TEST(LidarInfo, TellsSendersApart) {
  std::vector<Bytes> frames = point_frames(20);
  for (const Bytes& other : point_frames(5, 201)) frames.push_back(other);
  frames.push_back(lidar::frame(Bytes(10), 9, 0, 202));
  const Capture capture(frames, lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  EXPECT_THAT(info_of(capture.name()),
              AllOf(HasSubstr("26 UDP packets of 3 senders"), HasSubstr("\n192.168.1.200: RoboSense RS-LiDAR-16"),
                    HasSubstr("\n192.168.1.201: RoboSense RS-LiDAR-16"),
                    HasSubstr("\n192.168.1.202: an unknown device, whose points this program does not read"),
                    HasSubstr("9: 1 packets of 10 bytes")));
}

TEST(LidarInfo, NamesTheMakerOfPacketsThatItDoesNotRead) {
  std::vector<Bytes> frames;
  for (int i = 0; i < 5; ++i) frames.push_back(lidar::frame(lidar::models::ouster_packet(true, 128, 16), 7502, 0, 7));
  for (int i = 0; i < 4; ++i) frames.push_back(lidar::frame(lidar::models::hesai_xt_packet(), 2368, 0, 8));
  for (int i = 0; i < 3; ++i) frames.push_back(lidar::frame(lidar::models::livox_packet(), 56301, 0, 9));
  const Capture capture(frames);
  EXPECT_THAT(info_of(capture.name()),
              AllOf(HasSubstr("192.168.1.7: an Ouster LiDAR, whose points this program does not read"),
                    HasSubstr("192.168.1.8: a Hesai LiDAR, whose points this program does not read"),
                    HasSubstr("192.168.1.9: a Livox LiDAR, whose points this program does not read")));
}

TEST(LidarInfo, BelievesNoDamagedDeviceInformation) {
  std::vector<Bytes> frames = point_frames(100);
  Bytes damaged = info_frame();
  damaged[42 + 292] ^= 0x55;                                   // serial number
  damaged[42 + 41] = damaged[42 + 42] = damaged[42 + 43] = 0;  // a firmware that counts in centimetres
  for (const int at : {30, 60}) frames.insert(frames.begin() + at, info_frame());
  const Capture good(frames, lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  frames.push_back(damaged);
  const Capture bad(frames, lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const auto from = [](const std::string& text, const char* what) {
    const std::size_t at = text.find(what);
    return text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_EQ(from(info_of(good.name()), "points "), from(info_of(bad.name()), "points "));
  EXPECT_EQ(from(info_of(good.name()), "identity "), from(info_of(bad.name()), "identity "));
  EXPECT_THAT(info_of(bad.name()), HasSubstr("identity  serial number"));
}

TEST(LidarInfo, AsksTheDeviceInformationHowManyLasersAHeliosHas) {
  using namespace lidar::models::helios;
  for (const int infos : {1, 2}) {
    std::vector<Bytes> frames(static_cast<std::size_t>(infos), lidar::frame(info(32), 7788));
    for (int i = 0; i < 20; ++i) {
      MsopPacket packet = points(i * 480, 40, kStart + i * 1333);
      packet.type[0] = 0x07;
      packet.type[1] = packet.type[2] = 0;
      frames.push_back(lidar::frame(bytes_of(packet), 6699));
    }
    const Capture capture(frames, lidar::kEthernet, Capture::Format::kMicroseconds, 1333);
    EXPECT_THAT(info_of(capture.name()), HasSubstr("(model: helios32)")) << infos;
  }
}

TEST(LidarInfo, ReadsWhatThereIsOfACaptureThatIsCutOff) {
  const Capture capture(point_frames(20));
  capture.cut(3);
  EXPECT_THAT(info_of(capture.name()), HasSubstr("19 UDP packets"));
}

TEST(LidarInfo, SaysWhatACaptureHasInsteadOfPackets) {
  Bytes fragment = lidar::frame(Bytes(600), 6699);
  fragment[14 + 6] = 0x20;
  Bytes ipv6 = fragment;
  ipv6[12] = 0x86;
  ipv6[13] = 0xDD;
  Bytes cut = lidar::frame(Bytes(600), 6699);
  cut.resize(96);
  const Capture capture({fragment, fragment, ipv6, cut});
  EXPECT_THAT(info_of(capture.name()), HasSubstr("capture: 0 UDP packets of 0 senders; 2 IP fragments; 1 frames cut "
                                                 "off; 1 frames that are not UDP over IPv4\n"));
}

TEST(LidarInfo, SurvivesNoise) {
  const Capture capture({{},
                         {1, 2, 3},
                         lidar::frame({}, 6699),
                         lidar::frame(Bytes(1248), 6699),
                         lidar::frame(Bytes(1206, 0xFF), 2368),
                         lidar::frame(Bytes(512), 8308)});
  EXPECT_THAT(info_of(capture.name()), HasSubstr("4 UDP packets"));
}

/// Sends packets to kPort until it goes.
class Sending {
 public:
  ~Sending() {
    stop_ = true;
    thread_.join();
    close(fd_);
  }

 private:
  void run() const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(kPort);
    inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
    const auto packets = lidar::drive_packets(kStart, 50);
    for (std::size_t i = 0; !stop_; ++i) {
      const auto& packet = packets[i % packets.size()];
      (void)!sendto(fd_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
      usleep(2000);
    }
  }
  std::atomic<bool> stop_{false};
  int fd_ = socket(AF_INET, SOCK_DGRAM, 0);
  std::thread thread_{[this] { run(); }};
};

TEST(LidarInfo, ListensOnAPort) {
  const Sending device;
  const auto packets = packets_from(std::to_string(kPort), {.seconds = 0.5});
  EXPECT_THAT(info_text(*packets, "port"),
              AllOf(HasSubstr("127.0.0.1: RoboSense RS-LiDAR-16"), Not(HasSubstr(" 0 UDP"))));
}

TEST(LidarInfo, SaysWhatToLookForWhenNothingComes) {
  EXPECT_THAT(
      [] { (void)packets_from(std::to_string(kPort + 1), {.seconds = 0.1}); },
      ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("no packet came to port 46702"), HasSubstr("tcpdump"))));
  EXPECT_THAT([] { (void)packets_from("99999", {}); }, ThrowsMessage<std::runtime_error>(HasSubstr("no UDP port")));
}

}  // namespace
}  // namespace curbstone::lidar_tool
