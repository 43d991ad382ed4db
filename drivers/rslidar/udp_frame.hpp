#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace curbstone {

struct UdpFrame {
  int port = 0;  ///< destination
  std::span<const std::uint8_t> payload;
};

/// The UDP payload of an IPv4 packet. Nothing when it is something else, a fragment, or cut off.
[[nodiscard]] std::optional<UdpFrame> udp_in_ip(std::span<const std::uint8_t> packet);

/// Finds the IP packet in an Ethernet frame: `type_offset` is where the first EtherType stands (12; 14 in a Linux
/// cooked capture). VLAN tags are stepped over.
[[nodiscard]] std::optional<UdpFrame> udp_in_ethernet(std::span<const std::uint8_t> frame,
                                                      std::size_t type_offset = 12);

}  // namespace curbstone
