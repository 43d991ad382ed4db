#include "common/bus/socket/channel_filter.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace curbstone {
namespace {

constexpr std::uint32_t kUdpHeader = 8;
constexpr std::uint32_t kFragment = 0x4C433033;  // "LC03"
constexpr std::uint32_t kWhole = 0x4C433032;     // "LC02"
constexpr std::uint32_t kName = kUdpHeader + 8;  // where the channel's name begins
constexpr std::uint32_t kMaxName = 63;           // bytes
constexpr std::uint32_t kAll = 0xFFFFFFFF;       // bytes that pass

sock_filter statement(int code, std::uint32_t k) {
  return {static_cast<std::uint16_t>(code), 0, 0, k};
}

sock_filter jump(int code, std::uint32_t k, std::size_t if_true, std::size_t if_false) {
  return {static_cast<std::uint16_t>(code), static_cast<std::uint8_t>(if_true), static_cast<std::uint8_t>(if_false), k};
}

/// Continues for a whole message; discards everything else.
std::vector<sock_filter> whole_messages() {
  return {statement(BPF_LD | BPF_W | BPF_ABS, kUdpHeader), jump(BPF_JMP | BPF_JEQ | BPF_K, kWhole, 1, 0),
          statement(BPF_RET | BPF_K, 0)};
}

/// Passes a datagram if its name, at X, is `name`; otherwise continues behind. (Jumps reach 255 statements, enough for
/// names of 500 bytes. LCM's have at most 63.)
void match(const std::string& name, std::vector<sock_filter>& program) {
  struct Piece {
    std::size_t at;
    std::size_t size;  // 4, 2 or 1
  };
  const std::string_view bytes(name.c_str(), name.size() + 1);  // including its 0
  std::vector<Piece> pieces;
  for (std::size_t at = 0; at < bytes.size(); at += pieces.back().size) {
    const std::size_t left = bytes.size() - at;
    pieces.push_back({at, left >= 4 ? 4U : left >= 2 ? 2U : 1U});
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto [at, size] = pieces[i];
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < size; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes[at + k]);
    const int width = size == 4 ? BPF_W : size == 2 ? BPF_H : BPF_B;
    program.push_back(statement(BPF_LD | width | BPF_IND, static_cast<std::uint32_t>(at)));
    const std::size_t behind = 2 * (pieces.size() - 1 - i) + 1;  // the remaining pieces, and the pass
    program.push_back(jump(BPF_JMP | BPF_JEQ | BPF_K, value, 0, behind));
  }
  program.push_back(statement(BPF_RET | BPF_K, kAll));
}

}  // namespace

std::vector<sock_filter> make_channel_filter(std::vector<std::string> channels) {
  std::vector<sock_filter> program = whole_messages();
  program.push_back(statement(BPF_LDX | BPF_W | BPF_IMM, kName));
  // A read beyond the end of the datagram discards it. Short names therefore come first: a datagram with a longer name
  // contains every byte that they read.
  std::sort(channels.begin(), channels.end(),
            [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
  for (const std::string& channel : channels) match(channel, program);
  program.push_back(statement(BPF_RET | BPF_K, 0));
  return program;
}

std::vector<sock_filter> make_message_filter(bool with_fragments) {
  std::vector<sock_filter> program;
  if (with_fragments)
    program = {statement(BPF_LD | BPF_W | BPF_ABS, kUdpHeader), jump(BPF_JMP | BPF_JEQ | BPF_K, kFragment, 0, 1),
               statement(BPF_RET | BPF_K, kAll)};
  const std::vector<sock_filter> whole = whole_messages();
  program.insert(program.end(), whole.begin(), whole.end());
  // The end of the name is searched byte by byte: classic BPF has no loops.
  for (std::uint32_t i = 0; i <= kMaxName; ++i) {
    program.push_back(statement(BPF_LD | BPF_B | BPF_ABS, kName + i));
    program.push_back(jump(BPF_JMP | BPF_JEQ | BPF_K, 0, 0, 1));
    program.push_back(statement(BPF_RET | BPF_K, i == 0 ? 0 : kAll));
  }
  program.push_back(statement(BPF_RET | BPF_K, 0));
  return program;
}

}  // namespace curbstone
