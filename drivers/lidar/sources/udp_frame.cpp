#include "drivers/lidar/sources/udp_frame.hpp"

#include "common/bytes/big_endian.hpp"

namespace curbstone::lidar::sources {

namespace {

constexpr int kIpv4 = 0x0800;
constexpr int kVlan = 0x8100;
constexpr int kServiceVlan = 0x88A8;
constexpr std::uint8_t kUdp = 17;

int be16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return read_big_endian<std::uint16_t>(bytes.subspan(at));
}

}  // namespace

std::optional<UdpFrame> udp_in_ip(std::span<const std::uint8_t> packet) {
  if (packet.size() < 20 || packet[0] >> 4 != 4 || packet[9] != kUdp) return std::nullopt;
  const bool fragment = (be16(packet, 6) & 0x3FFF) != 0;
  const auto header = static_cast<std::size_t>(packet[0] & 0x0F) * 4;
  if (fragment || header < 20 || packet.size() < header + 8) return std::nullopt;
  const auto udp = packet.subspan(header);
  const auto length = static_cast<std::size_t>(be16(udp, 4));
  if (length < 8 || length > udp.size()) return std::nullopt;
  return UdpFrame{be16(udp, 2), udp.subspan(8, length - 8)};
}

std::optional<UdpFrame> udp_in_ethernet(std::span<const std::uint8_t> frame, std::size_t type_offset) {
  std::size_t at = type_offset;
  for (int tags = 0; tags <= 2 && at + 2 <= frame.size(); ++tags, at += 4) {
    const int type = be16(frame, at);
    if (type == kIpv4) return udp_in_ip(frame.subspan(at + 2));
    if (type != kVlan && type != kServiceVlan) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace curbstone::lidar::sources
