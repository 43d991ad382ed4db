#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar::sources {

/// What a captured frame is. All but kUdp have no payload that can be used.
enum class FrameKind {
  kUdp,
  kNotUdp,    ///< ARP, TCP, IPv6, ...
  kFragment,  ///< a part of an IPv4 packet that was longer than the network takes
  kCut,       ///< shorter than it says: captured with a limit on the length, or damaged
};

struct UdpFrame {
  FrameKind kind = FrameKind::kNotUdp;
  Ipv4 sender = 0;
  int port = 0;                           ///< destination
  std::span<const std::uint8_t> payload;  ///< within the frame
};

/// The UDP payload of an IPv4 packet. Any bytes may come. Source: RFC 768, RFC 791.
[[nodiscard]] UdpFrame udp_in_ip(std::span<const std::uint8_t> packet);

/// The same of what follows an EtherType. Up to two VLAN tags are skipped. Source: IEEE 802.1Q.
[[nodiscard]] UdpFrame udp_after(int ether_type, std::span<const std::uint8_t> rest);

/// The same of an Ethernet frame.
[[nodiscard]] UdpFrame udp_in_ethernet(std::span<const std::uint8_t> frame);

/// The same of a frame of a loopback interface: a family of addresses, in the byte order of the host that captured
/// (LINKTYPE_NULL) or of the network (LINKTYPE_LOOP), and the packet.
[[nodiscard]] UdpFrame udp_in_loopback(std::span<const std::uint8_t> frame);

/// The same of a Linux cooked frame (`tcpdump -i any`), version 1 and version 2. Source: LINKTYPE_LINUX_SLL and
/// LINKTYPE_LINUX_SLL2, tcpdump.org.
[[nodiscard]] UdpFrame udp_in_sll(std::span<const std::uint8_t> frame);
[[nodiscard]] UdpFrame udp_in_sll2(std::span<const std::uint8_t> frame);

}  // namespace curbstone::lidar::sources
