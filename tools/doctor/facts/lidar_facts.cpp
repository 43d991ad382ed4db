#include "tools/doctor/facts/lidar_facts.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/time/clock.hpp"
#include "drivers/lidar/sources/ipv4_address.hpp"
#include "drivers/lidar/sources/udp_frame.hpp"

namespace curbstone::doctor::facts {

namespace {

using Bytes = std::span<const std::uint8_t>;

/// Calls `on_packet(bytes, sender)` for each datagram of the socket, for `seconds`, and closes it.
template <class OnPacket>
void receive_for(int fd, double seconds, OnPacket on_packet) {
  std::vector<std::uint8_t> bytes(65536);
  const std::int64_t end = steady_clock() + static_cast<std::int64_t>(seconds * 1e6);
  for (std::int64_t now = steady_clock(); now < end; now = steady_clock()) {
    pollfd waiting{fd, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>((end - now) / 1000) + 1) <= 0) continue;
    sockaddr_storage sender{};
    socklen_t length = sizeof sender;
    const ssize_t size =
        recvfrom(fd, bytes.data(), bytes.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&sender), &length);
    if (size > 0) on_packet(Bytes(bytes.data(), static_cast<std::size_t>(size)), sender);
  }
  close(fd);
}

void count(std::map<std::string, std::int64_t>& packets, const std::string& name) {
  constexpr std::size_t kMaxNames = 32;
  if (packets.size() < kMaxNames || packets.contains(name)) ++packets[name];
}

void count(checks::LidarFacts& facts, lidar::sources::Ipv4 sender) {
  count(facts.packets, lidar::sources::to_text(sender));
}

/// The payload size of RoboSense's and Velodyne's point packets.
bool is_points_packet(std::size_t bytes) {
  return bytes == 1248 || bytes == 1206;
}

int open_port(int port) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(static_cast<std::uint16_t>(port));
  if (bind(fd, reinterpret_cast<const sockaddr*>(&any), sizeof any) == 0) return fd;
  close(fd);
  return -1;
}

}  // namespace

checks::LidarFacts probe_lidar(int port, double seconds) {
  checks::LidarFacts facts;
  facts.port = port;
  facts.seconds = seconds;
  if (const int wire = socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP)); wire >= 0) {
    facts.listened = true;
    receive_for(wire, seconds, [&](Bytes packet, const sockaddr_storage& from) {
      sockaddr_ll link{};
      std::memcpy(&link, &from, sizeof link);
      if (link.sll_pkttype == PACKET_OUTGOING) return;  // on loopback each packet appears twice
      const auto udp = lidar::sources::udp_in_ip(packet);
      if (udp.kind != lidar::sources::FrameKind::kUdp) return;
      if (udp.port == port)
        count(facts, udp.sender);
      else if (is_points_packet(udp.payload.size()))
        count(facts.elsewhere, fmt::format("port {}, from {}", udp.port, lidar::sources::to_text(udp.sender)));
    });
  } else if (const int fd = open_port(port); fd >= 0) {
    facts.listened = true;
    receive_for(fd, seconds, [&](Bytes, const sockaddr_storage& from) {
      sockaddr_in sender{};
      std::memcpy(&sender, &from, sizeof sender);
      count(facts, ntohl(sender.sin_addr.s_addr));
    });
  }
  return facts;
}

}  // namespace curbstone::doctor::facts
