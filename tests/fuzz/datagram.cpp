// The kernel's filter before LCM, in libpcap's interpreter: it passes a datagram if, and only if, LCM 1.3.1 can take it
// without harm. Input: the UDP payload.
#include <pcap/pcap.h>

#include <cstring>
#include <string>
#include <vector>

#include "common/bus/socket/channel_filter.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

constexpr std::size_t kUdpHeader = 8, kLcmHeader = 8;

bool passes(const std::vector<sock_filter>& program, const std::vector<std::uint8_t>& datagram) {
  static_assert(sizeof(sock_filter) == sizeof(bpf_insn));
  std::vector<bpf_insn> instructions(program.size());
  std::memcpy(instructions.data(), program.data(), program.size() * sizeof(sock_filter));
  const auto size = static_cast<unsigned>(datagram.size());
  return bpf_filter(instructions.data(), datagram.data(), size, size) != 0;
}

/// The name of the channel, if this is a whole message with one of 1 to 63 bytes.
std::string channel_of(Bytes payload) {
  if (payload.size() < kLcmHeader || std::memcmp(payload.data(), "LC02", 4) != 0) return {};
  const Bytes behind = payload.subspan(kLcmHeader);
  const auto end = std::find(behind.begin(), behind.end(), 0);
  if (end == behind.end() || end - behind.begin() > 63) return {};
  return {behind.begin(), end};
}

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  static const std::vector<std::string> channels = {"IMU", "WHEELS", "LIDAR_POINTS", "MAP_POSE", "M"};
  static const std::vector<sock_filter> any = make_message_filter();
  static const std::vector<sock_filter> some = make_channel_filter(channels);
  std::vector<std::uint8_t> datagram(fuzz::kUdpHeader, 0);
  datagram.insert(datagram.end(), data, data + size);
  const std::string channel = fuzz::channel_of({data, size});
  fuzz::require(fuzz::passes(any, datagram) == !channel.empty(), "whole messages pass, and nothing else");
  const bool wanted = std::find(channels.begin(), channels.end(), channel) != channels.end();
  fuzz::require(fuzz::passes(some, datagram) == wanted, "messages on these channels pass, and nothing else");
  return 0;
}
