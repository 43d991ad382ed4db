#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace curbstone::lidar::sources {

struct UdpFrame {
  int port = 0;  ///< destination
  std::span<const std::uint8_t> payload;
};

/// The UDP payload of an IPv4 packet. Nothing when it is something else, a fragment, or cut off.
[[nodiscard]] std::optional<UdpFrame> udp_in_ip(std::span<const std::uint8_t> packet);

/// The UDP payload of an Ethernet frame. `type_offset`: bytes before the first EtherType, 12, or 14 in a Linux cooked
/// capture. Up to two VLAN tags are skipped.
[[nodiscard]] std::optional<UdpFrame> udp_in_ethernet(std::span<const std::uint8_t> frame,
                                                      std::size_t type_offset = 12);

}  // namespace curbstone::lidar::sources
