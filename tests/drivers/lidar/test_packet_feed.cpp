#include "drivers/lidar/packet_feed.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <memory>

#include "common/bus/local_bus.hpp"
#include "common/time/clock.hpp"
#include "tests/drivers/lidar/packets.hpp"

namespace curbstone::lidar {
namespace {

constexpr std::uint16_t kPort = 6699;
constexpr std::int64_t kPatience = 20'000'000;  // us: more than a busy machine needs

/// A device on this host with an address of its own, 127.0.0.`last`.
class Device {
 public:
  explicit Device(std::uint32_t last) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    const sockaddr_in own = address(INADDR_LOOPBACK - 1 + last, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
  }
  ~Device() { close(socket_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void send() {
    const auto packet = drive_packets(wall_clock(), 1).front();
    const sockaddr_in driver = address(INADDR_LOOPBACK, kPort);
    sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&driver), sizeof driver);
  }

 private:
  static sockaddr_in address(std::uint32_t host, std::uint16_t port) {
    sockaddr_in of{};
    of.sin_family = AF_INET;
    of.sin_addr.s_addr = htonl(host);
    of.sin_port = htons(port);
    return of;
  }
  int socket_;
};

TEST(NetworkFeed, SaysThatTwoDevicesSendUntilNeitherDoes) {
  LidarConfig config;
  config.msop_port = kPort;
  LocalBus bus;
  LidarNode node(config, bus);
  EventLoop loop;
  const auto feed = feed_from_network(config, node, loop);
  Device first(2);
  Device second(3);
  const auto is_said = [&] {
    return std::ranges::any_of(node.report().faults,
                               [](const auto& fault) { return fault.starts_with("two devices send"); });
  };
  bool was_said = false;
  const std::int64_t end = steady_clock() + kPatience;
  loop.every(std::chrono::milliseconds(10), [&] {
    was_said = was_said || is_said();
    if (!was_said) {
      first.send();
      second.send();
    }
    if ((was_said && !is_said()) || steady_clock() > end) loop.stop();
  });
  loop.run();
  EXPECT_TRUE(was_said);
  EXPECT_FALSE(is_said()) << "both have been silent";
}

TEST(NetworkFeed, OpensAPortThatSomebodyElseHadAsSoonAsItIsFree) {
  LidarConfig config;
  config.msop_port = kPort;
  LocalBus bus;
  LidarNode node(config, bus);
  EventLoop loop;
  auto other = std::make_unique<sources::UdpSource>(kPort, sources::UdpOptions{});
  const auto feed = feed_from_network(config, node, loop);
  const auto is_said = [&] {
    return std::ranges::any_of(node.report().faults,
                               [](const auto& fault) { return fault.find("in use by another") != std::string::npos; });
  };
  EXPECT_TRUE(is_said());
  Device device(2);
  const auto packets = [&] { return node.report().counters["packets"]; };
  const std::int64_t begin = steady_clock();
  loop.every(std::chrono::milliseconds(10), [&] {
    if (other && steady_clock() - begin > 300'000) other.reset();
    device.send();
    if (packets() > 0 || steady_clock() > begin + kPatience) loop.stop();
  });
  loop.run();
  EXPECT_FALSE(other);
  EXPECT_FALSE(is_said());
  EXPECT_GT(packets(), 0);
}

}  // namespace
}  // namespace curbstone::lidar
