#include "services/relay/frame.hpp"

#include <algorithm>

#include "common/bytes/big_endian.hpp"

namespace curbstone::relay {

namespace {

constexpr std::array<std::uint8_t, 4> kMagic = {'C', 'B', 'R', '1'};
constexpr std::ptrdiff_t kMaxChannelName = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

}  // namespace

std::array<std::uint8_t, kFrameHeader> encode_frame_header(std::uint64_t run, std::uint32_t number) {
  std::array<std::uint8_t, kFrameHeader> header{};
  const BigEndian<std::uint64_t> run_bytes(run);
  const BigEndian<std::uint32_t> number_bytes(number);
  auto to = std::copy(kMagic.begin(), kMagic.end(), header.begin());
  to = std::copy(std::begin(run_bytes.bytes), std::end(run_bytes.bytes), to);
  std::copy(std::begin(number_bytes.bytes), std::end(number_bytes.bytes), to);
  return header;
}

std::optional<Frame> decode_frame(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kFrameHeader || !std::equal(kMagic.begin(), kMagic.end(), datagram.begin())) return {};
  Frame frame;
  frame.run = read_big_endian<std::uint64_t>(datagram.subspan(4));
  frame.number = read_big_endian<std::uint32_t>(datagram.subspan(12));
  const auto message = datagram.subspan(kFrameHeader);
  if (message.empty()) return frame;
  const auto end = std::find(message.begin(), message.end(), 0);
  const auto length = end - message.begin();
  if (end == message.end() || length < 1 || length > kMaxChannelName) return {};
  frame.channel = {reinterpret_cast<const char*>(message.data()), static_cast<std::size_t>(length)};
  frame.data = message.subspan(static_cast<std::size_t>(length) + 1);
  return frame;
}

}  // namespace curbstone::relay
