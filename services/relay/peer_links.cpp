#include "services/relay/peer_links.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "services/relay/datagram_parts.hpp"
#include "services/relay/frame.hpp"

namespace curbstone::relay {

namespace {

constexpr std::size_t kMaxDatagram = 65'536;
constexpr int kSocketBuffer = 1 << 22;  // bytes: a revolution's tiles at once; limited by net.core.[rw]mem_max
constexpr int kAtOnce = 64;             // datagrams, after which the bus is served

std::string to_text(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return fmt::format("{}:{}", text.data(), ntohs(address.sin_port));
}

}  // namespace

PeerLinks::PeerLinks(int port, const std::vector<sockaddr_in>& peers, std::uint64_t run)
    : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)),
      run_(run),
      buffer_(std::make_unique_for_overwrite<std::uint8_t[]>(kMaxDatagram)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "socket");
  setsockopt(fd_, SOL_SOCKET, SO_SNDBUF, &kSocketBuffer, sizeof kSocketBuffer);
  setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &kSocketBuffer, sizeof kSocketBuffer);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(static_cast<std::uint16_t>(port));
  if (bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
    const int error = errno;
    close(fd_);
    throw std::system_error(error, std::generic_category(), fmt::format("UDP port {}", port));
  }
  for (const sockaddr_in& address : peers) peers_.emplace_back().address = address;
}

PeerLinks::~PeerLinks() {
  close(fd_);
}

void PeerLinks::send(std::string_view channel, std::span<const std::uint8_t> data) {
  for (Peer& peer : peers_) {
    if (peer.is_self) continue;
    const auto header = encode_frame_header(run_, peer.sent++);
    auto parts = datagram_parts(header, channel, data);
    msghdr message{};
    message.msg_name = &peer.address;
    message.msg_namelen = sizeof peer.address;
    message.msg_iov = parts.data();
    message.msg_iovlen = channel.empty() ? 1 : parts.size();
    if (sendmsg(fd_, &message, MSG_DONTWAIT) < 0) counters_.add("dropped.peer");
  }
}

void PeerLinks::receive(std::int64_t now, const Handler& handler) {
  for (int i = 0; i < kAtOnce; ++i) {
    sockaddr_in from{};
    socklen_t from_size = sizeof from;
    const auto size =
        recvfrom(fd_, buffer_.get(), kMaxDatagram, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) return;
    Peer* const peer = find(from);
    const auto frame = decode_frame({buffer_.get(), static_cast<std::size_t>(size)});
    if (peer == nullptr || !frame) {
      counters_.add("refused.datagram");
      continue;
    }
    peer->is_self = frame->run == run_;
    if (peer->is_self) continue;
    note_number(*peer, *frame, now);
    if (!frame->channel.empty()) handler(frame->channel, frame->data);
  }
}

PeerLinks::Peer* PeerLinks::find(const sockaddr_in& address) {
  const auto it = std::find_if(peers_.begin(), peers_.end(), [&](const Peer& peer) {
    return peer.address.sin_addr.s_addr == address.sin_addr.s_addr && peer.address.sin_port == address.sin_port;
  });
  return it == peers_.end() ? nullptr : &*it;
}

/// Counts a gap as a loss; a datagram that arrives late takes its loss back.
void PeerLinks::note_number(Peer& peer, const Frame& frame, std::int64_t now) {
  const bool goes_on = peer.last_heard && peer.run == frame.run;
  peer.last_heard = now;
  peer.run = frame.run;
  const auto ahead = static_cast<std::int32_t>(frame.number - peer.next);
  if (goes_on && ahead < 0) {
    if (counters_["lost.peer"] > 0) counters_.add("lost.peer", -1);
    return;
  }
  counters_.add("lost.peer", goes_on ? ahead : 0);
  peer.next = frame.number + 1;
}

std::vector<std::string> PeerLinks::silent(std::int64_t now, std::int64_t start, std::int64_t for_us) const {
  std::vector<std::string> names;
  for (const Peer& peer : peers_) {
    if (!peer.is_self && now - peer.last_heard.value_or(start) > for_us) names.push_back(to_text(peer.address));
  }
  return names;
}

}  // namespace curbstone::relay
