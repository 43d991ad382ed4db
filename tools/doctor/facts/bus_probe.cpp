#include "tools/doctor/facts/bus_probe.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <curbstone/service_status_t.hpp>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/shell/status_reporter.hpp"
#include "common/time/clock.hpp"

namespace curbstone::doctor::facts {

namespace {

constexpr std::string_view kChannel = "CURBSTONE_DOCTOR";

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(errno)));
}

class ProbeSocket {
 public:
  explicit ProbeSocket(const BusAddress& address) : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (fd_ < 0) fail("socket");
    group_.sin_family = AF_INET;
    group_.sin_port = htons(static_cast<std::uint16_t>(address.port));
    inet_pton(AF_INET, address.group.c_str(), &group_.sin_addr);
    set(SOL_SOCKET, SO_REUSEADDR, 1);
    set(IPPROTO_IP, IP_PKTINFO, 1);
    set(IPPROTO_IP, IP_MULTICAST_TTL, address.ttl);
    if (address.buffer > 0) set(SOL_SOCKET, SO_RCVBUF, address.buffer);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_port = group_.sin_port;
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0)
      fail(fmt::format("port {} cannot be opened", address.port));
    ip_mreq membership{};
    membership.imr_multiaddr = group_.sin_addr;
    if (setsockopt(fd_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0)
      fail(fmt::format("{} cannot be joined", address.group));
  }
  ~ProbeSocket() { close(fd_); }
  ProbeSocket(const ProbeSocket&) = delete;
  ProbeSocket& operator=(const ProbeSocket&) = delete;

  /// bytes, including the kernel's book-keeping, so twice the requested size (socket(7)).
  [[nodiscard]] int granted_buffer() const {
    int size = 0;
    socklen_t length = sizeof size;
    getsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &size, &length);
    return size / 2;
  }
  void send(const std::string& bytes) const {
    if (sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&group_), sizeof group_) < 0)
      fail("a message cannot be sent");
  }
  struct Datagram {
    std::string_view bytes;
    in_addr group{};
  };
  /// Waits at most `timeout` us. The bytes are valid until the next call.
  std::optional<Datagram> receive(std::int64_t timeout) {
    pollfd waiting{fd_, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(timeout / 1000) + 1) <= 0) return std::nullopt;
    iovec part{bytes_.data(), bytes_.size()};
    alignas(cmsghdr) std::array<char, 256> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = recvmsg(fd_, &message, MSG_DONTWAIT);
    if (size < 0) return std::nullopt;
    Datagram datagram{{bytes_.data(), static_cast<std::size_t>(size)}, group_.sin_addr};
    for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
      if (header->cmsg_level != IPPROTO_IP || header->cmsg_type != IP_PKTINFO) continue;
      in_pktinfo info{};
      std::memcpy(&info, CMSG_DATA(header), sizeof info);
      datagram.group = info.ipi_addr;
    }
    return datagram;
  }
  [[nodiscard]] in_addr group() const { return group_.sin_addr; }

 private:
  void set(int level, int option, int value) const { setsockopt(fd_, level, option, &value, sizeof value); }

  int fd_;
  sockaddr_in group_{};
  std::array<char, 65536> bytes_{};
};

/// A complete message of LCM 1.3.1, lcm_udpm.c: "LC02", sequence number, channel, 0, data.
std::string own_message() {
  std::string bytes("LC02\0\0\0\0", 8);
  return bytes.append(kChannel).append(1, '\0').append(fmt::format("{}:{}", getpid(), steady_clock()));
}

/// The channel of a complete message or of the first fragment; empty for others.
std::string channel_of(std::string_view bytes) {
  const std::size_t header = bytes.starts_with("LC03") ? 20 : 8;
  if (bytes.size() <= header) return "";
  const auto name = bytes.substr(header, bytes.find('\0', header) - header);
  return std::string(name.substr(0, 63));
}

/// Of a SERVICE_STATUS that arrived whole, with its channel.
void note_config(std::string_view bytes, checks::BusProbeFacts& facts) {
  constexpr std::size_t kMaxServices = 100;
  const std::size_t begin = bytes.find('\0', 8) + 1;
  if (!bytes.starts_with("LC02") || begin == 0) return;
  service_status_t status;
  const auto size = static_cast<int>(bytes.size() - begin);
  if (status.decode(bytes.data() + begin, 0, size) != size || status.host != host_name()) return;
  if (!status.config_hash.empty() && facts.config_hashes.size() < kMaxServices)
    facts.config_hashes[status.service] = status.config_hash;
}

/// The drops of all sockets that are bound to the port: proc(5), /proc/net/udp.
std::int64_t drops_at(int port) {
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);
  std::int64_t sum = 0;
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string number, local, word;
    words >> number >> local;
    std::int64_t drops = 0;
    while (words >> word) std::from_chars(word.data(), word.data() + word.size(), drops);  // the last column
    const auto colon = local.find(':');
    int bound = 0;
    if (colon != std::string::npos) std::from_chars(local.data() + colon + 1, local.data() + local.size(), bound, 16);
    if (bound == port) sum += drops;
  }
  return sum;
}

void listen(ProbeSocket& socket, double seconds, const std::string& unrecorded, checks::BusProbeFacts& facts) {
  constexpr std::size_t kMaxNames = 1000;  // any sender may use any names
  const std::string own = own_message();
  const std::int64_t begin = steady_clock(), end = begin + static_cast<std::int64_t>(seconds * 1e6);
  socket.send(own);
  for (std::int64_t now = begin; now < end; now = steady_clock()) {
    const auto datagram = socket.receive(end - now);
    if (!datagram) continue;
    if (datagram->group.s_addr != socket.group().s_addr) {
      std::array<char, INET_ADDRSTRLEN> text{};
      inet_ntop(AF_INET, &datagram->group, text.data(), text.size());
      if (facts.other_groups.size() < kMaxNames) ++facts.other_groups[text.data()];
    } else if (datagram->bytes == own) {
      if (!facts.round_trip) facts.round_trip = steady_clock() - begin;
    } else {
      const std::string channel = channel_of(datagram->bytes);
      if (channel != unrecorded) facts.bytes += static_cast<std::int64_t>(datagram->bytes.size());
      if (facts.messages.size() < kMaxNames) ++facts.messages[channel];
      if (channel == "SERVICE_STATUS") note_config(datagram->bytes, facts);
    }
  }
  facts.seconds = seconds;
}

}  // namespace

checks::BusProbeFacts probe_bus(const BusAddress& address, double seconds, const std::string& unrecorded) {
  checks::BusProbeFacts facts;
  try {
    ProbeSocket socket(address);
    facts.granted_buffer = socket.granted_buffer();
    facts.kernel_drops = drops_at(address.port);
    listen(socket, seconds, unrecorded, facts);
  } catch (const std::runtime_error& error) {
    facts.error = error.what();
  }
  return facts;
}

}  // namespace curbstone::doctor::facts
