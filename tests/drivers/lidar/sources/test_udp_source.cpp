#include "drivers/lidar/sources/udp_source.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <vector>

#include "common/time/clock.hpp"

namespace curbstone::lidar::sources {
namespace {

using ::testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kPort = 46699;

UdpOptions options(const char* host, const char* group, int buffer, const char* device = "") {
  return {host, group, buffer, device};
}

class Sender {
 public:
  explicit Sender(const char* to = "127.0.0.1", int port = kPort) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, to, &to_.sin_addr);
  }
  ~Sender() { close(fd_); }
  void send(const std::vector<std::uint8_t>& bytes) const {
    ASSERT_EQ(sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_),
              static_cast<ssize_t>(bytes.size()));
  }

 private:
  int fd_ = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_{};
};

struct Arrived {
  std::int64_t received;
  int port;
  std::vector<std::uint8_t> bytes;
};

/// Everything that arrives until nothing does for 0.2 s.
std::vector<Arrived> all_of(UdpSource& source) {
  std::vector<Arrived> arrived;
  pollfd watch{source.fd(), POLLIN, 0};
  while (poll(&watch, 1, 200) > 0) {
    source.receive([&](std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
      arrived.push_back({received, port, {bytes.begin(), bytes.end()}});
    });
  }
  return arrived;
}

TEST(UdpSource, HandsOverPacketsWithTheKernelsTime) {
  UdpSource source(kPort, {});
  const Sender sender;
  // The kernel begins to stamp a little after the first socket asks for it; packets before that get the time of
  // reading.
  bool stamps = false;
  for (int i = 0; i < 400 && !stamps; ++i) {
    sender.send({});
    usleep(5000);
    const std::int64_t read = wall_clock();
    source.receive([&](std::int64_t received, int, std::span<const std::uint8_t>) { stamps = received < read - 4000; });
  }
  ASSERT_TRUE(stamps) << "all had the time of reading";
  const std::int64_t before = wall_clock();
  for (std::uint8_t i = 0; i < 200; ++i) sender.send(std::vector<std::uint8_t>(1248, i));
  const std::int64_t after = wall_clock();
  usleep(20'000);
  const auto arrived = all_of(source);
  ASSERT_EQ(arrived.size(), 200U);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    EXPECT_EQ(arrived[i].bytes, std::vector<std::uint8_t>(1248, static_cast<std::uint8_t>(i)));
    EXPECT_EQ(arrived[i].port, kPort);
    EXPECT_GE(arrived[i].received, before - 1000);
    EXPECT_LE(arrived[i].received, after + 1000);
  }
  EXPECT_EQ(source.dropped(), 0);
}

TEST(UdpSource, HandsOverEmptyAndOversizedPacketsAsSuch) {
  UdpSource source(kPort, {});
  const Sender sender;
  sender.send({});
  sender.send(std::vector<std::uint8_t>(9000, 1));
  sender.send({1, 2});
  const auto arrived = all_of(source);
  ASSERT_EQ(arrived.size(), 3U);
  EXPECT_EQ(arrived[0].bytes.size(), 0U);
  EXPECT_EQ(arrived[1].bytes.size(), 9000U) << "whole: another maker's are as long";
  EXPECT_EQ(arrived[2].bytes, (std::vector<std::uint8_t>{1, 2}));
}

TEST(UdpSource, CountsWhatTheKernelThrewAway) {
  UdpSource source(kPort, options("0.0.0.0", "", 65536));
  const Sender sender;
  for (int i = 0; i < 1000; ++i) sender.send(std::vector<std::uint8_t>(1248));
  auto arrived = all_of(source);
  sender.send({1});  // the kernel tells its count with the next packet
  const auto rest = all_of(source);
  EXPECT_LT(arrived.size(), 1000U);
  EXPECT_EQ(source.dropped(), 1000 - static_cast<std::int64_t>(arrived.size()));
}

TEST(UdpSource, HandsOverPacketsOfTheDeviceOnlyAndCountsTheOthers) {
  UdpSource device(kPort, options("0.0.0.0", "", 65536, "127.0.0.1"));
  const Sender sender;
  sender.send({1});
  EXPECT_EQ(all_of(device).size(), 1U);
  EXPECT_EQ(to_text(device.sender()), "127.0.0.1");
  EXPECT_EQ(device.foreign(), 0);

  UdpSource other(kPort + 1, options("0.0.0.0", "", 65536, "127.0.0.2"));
  const Sender stranger("127.0.0.1", kPort + 1);
  for (int i = 0; i < 3; ++i) stranger.send({1});
  EXPECT_EQ(all_of(other).size(), 0U);
  EXPECT_EQ(other.foreign(), 3);
}

TEST(UdpSource, JoinsAMulticastGroup) {
  UdpSource source(kPort, options("127.0.0.1", "239.255.66.99", 1 << 20));
  const Sender sender("239.255.66.99");
  sender.send({7});
  EXPECT_EQ(all_of(source).size(), 1U);
}

TEST(UdpSource, SaysWhatIsWrongWithPortAndAddress) {
  const UdpSource first(kPort, {});
  EXPECT_THAT([] { UdpSource(kPort, {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("port 46699 is in use by another process")));
  EXPECT_THAT([] { UdpSource(kPort + 1, options("192.0.2.1", "", 65536)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no interface with address 192.0.2.1")));
  EXPECT_THAT([] { UdpSource(kPort + 1, options("lidar", "", 65536)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'lidar' is no IPv4 address")));
  EXPECT_THAT([] { UdpSource(kPort + 1, options("0.0.0.0", "", 65536, "192.168.1")); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("device_address: '192.168.1' is no IPv4 address")));
  EXPECT_THAT([] { UdpSource(kPort + 1, options("127.0.0.1", "10.0.0.1", 65536)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("cannot join 10.0.0.1")));
}

}  // namespace
}  // namespace curbstone::lidar::sources
