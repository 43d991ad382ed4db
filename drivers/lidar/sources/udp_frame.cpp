#include "drivers/lidar/sources/udp_frame.hpp"

#include "common/bytes/big_endian.hpp"

namespace curbstone::lidar::sources {

namespace {

constexpr int kIpv4 = 0x0800;
constexpr int kVlan = 0x8100;
constexpr int kServiceVlan = 0x88A8;
constexpr int kOldServiceVlan = 0x9100;
constexpr std::uint8_t kUdp = 17;

using Bytes = std::span<const std::uint8_t>;

int be16(Bytes bytes, std::size_t at) {
  return read_big_endian<std::uint16_t>(bytes.subspan(at));
}

UdpFrame none(FrameKind kind) {
  return {kind, 0, 0, {}};
}

UdpFrame udp_at(Bytes frame, std::size_t type_offset, std::size_t rest_offset) {
  if (frame.size() < rest_offset) return none(FrameKind::kCut);
  return udp_after(be16(frame, type_offset), frame.subspan(rest_offset));
}

}  // namespace

UdpFrame udp_in_ip(Bytes packet) {
  if (packet.size() < 20) return none(FrameKind::kCut);
  if (packet[0] >> 4 != 4 || packet[9] != kUdp) return none(FrameKind::kNotUdp);
  if ((be16(packet, 6) & 0x3FFF) != 0) return none(FrameKind::kFragment);
  const auto header = static_cast<std::size_t>(packet[0] & 0x0F) * 4;
  if (header < 20 || packet.size() < header + 8) return none(FrameKind::kCut);
  const Bytes udp = packet.subspan(header);
  const auto length = static_cast<std::size_t>(be16(udp, 4));
  if (length < 8 || length > udp.size()) return none(FrameKind::kCut);
  return {FrameKind::kUdp, read_big_endian<std::uint32_t>(packet.subspan(12)), be16(udp, 2),
          udp.subspan(8, length - 8)};
}

UdpFrame udp_after(int ether_type, Bytes rest) {
  const auto is_tag = [](int type) { return type == kVlan || type == kServiceVlan || type == kOldServiceVlan; };
  for (int tags = 0; tags < 2 && is_tag(ether_type); ++tags) {
    if (rest.size() < 4) return none(FrameKind::kCut);
    ether_type = be16(rest, 2);
    rest = rest.subspan(4);
  }
  return ether_type == kIpv4 ? udp_in_ip(rest) : none(FrameKind::kNotUdp);
}

UdpFrame udp_in_ethernet(Bytes frame) {
  return udp_at(frame, 12, 14);
}

/// The family is 2 for IPv4 on all systems, so one byte identifies it, at whichever end it is.
UdpFrame udp_in_loopback(Bytes frame) {
  if (frame.size() < 4) return none(FrameKind::kCut);
  const bool ipv4 = frame[1] == 0 && frame[2] == 0 && (frame[0] | frame[3]) == 2 && (frame[0] & frame[3]) == 0;
  return ipv4 ? udp_in_ip(frame.subspan(4)) : none(FrameKind::kNotUdp);
}

UdpFrame udp_in_sll(Bytes frame) {
  return udp_at(frame, 14, 16);
}

UdpFrame udp_in_sll2(Bytes frame) {
  return udp_at(frame, 0, 20);
}

}  // namespace curbstone::lidar::sources
