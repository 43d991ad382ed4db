#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar::sources {

/// Kind of a captured frame. Only kUdp has a usable payload.
enum class FrameKind {
  kUdp,
  kNotUdp,     ///< ARP, TCP, IPv6, ...
  kFragment,   ///< a part of an IPv4 packet that was longer than the network takes
  kOtherLink,  ///< of an interface whose link type is not supported
  kCut,        ///< shorter than its stated length: captured with a length limit, or damaged
};

struct UdpFrame {
  FrameKind kind = FrameKind::kNotUdp;
  Ipv4 sender = 0;
  int port = 0;                           ///< destination
  std::span<const std::uint8_t> payload;  ///< within the frame
};

/// Extracts the UDP payload of an IPv4 packet. Any bytes are allowed. Source: RFC 768, RFC 791.
[[nodiscard]] UdpFrame udp_in_ip(std::span<const std::uint8_t> packet);

/// The same for the bytes after an EtherType. Up to two VLAN tags are skipped. Source: IEEE 802.1Q.
[[nodiscard]] UdpFrame udp_after(int ether_type, std::span<const std::uint8_t> rest);

/// The same for an Ethernet frame.
[[nodiscard]] UdpFrame udp_in_ethernet(std::span<const std::uint8_t> frame);

/// The same for a frame of a loopback interface: an address family, in the byte order of the capturing host
/// (LINKTYPE_NULL) or of the network (LINKTYPE_LOOP), and the packet.
[[nodiscard]] UdpFrame udp_in_loopback(std::span<const std::uint8_t> frame);

/// The same for a Linux cooked frame (`tcpdump -i any`), version 1 and version 2. Source: LINKTYPE_LINUX_SLL and
/// LINKTYPE_LINUX_SLL2, tcpdump.org.
[[nodiscard]] UdpFrame udp_in_sll(std::span<const std::uint8_t> frame);
[[nodiscard]] UdpFrame udp_in_sll2(std::span<const std::uint8_t> frame);

}  // namespace curbstone::lidar::sources
