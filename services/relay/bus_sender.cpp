#include "services/relay/bus_sender.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "common/bytes/big_endian.hpp"
#include "services/relay/datagram_parts.hpp"

namespace curbstone::relay {

namespace {

[[noreturn]] void fail_sender(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

BusSender::BusSender(const BusAddress& address) : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  if (fd_ < 0) fail_sender("socket");
  // Not connected: from a socket with a source address, multicast leaves by that address's interface, not by the route.
  group_.sin_family = AF_INET;
  group_.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.group.c_str(), &group_.sin_addr);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  socklen_t size = sizeof own;
  const auto ttl = static_cast<std::uint8_t>(address.ttl);
  if (setsockopt(fd_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl) != 0 ||
      bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      getsockname(fd_, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    const int error = errno;
    close(fd_);
    errno = error;
    fail_sender("the bus");
  }
  port_ = ntohs(own.sin_port);
}

BusSender::~BusSender() {
  close(fd_);
}

bool BusSender::send(std::string_view channel, std::span<const std::uint8_t> data) {
  std::array<std::uint8_t, 8> header = {'L', 'C', '0', '2'};
  const BigEndian<std::uint32_t> number(number_++);
  std::copy(std::begin(number.bytes), std::end(number.bytes), header.begin() + 4);
  auto parts = datagram_parts(header, channel, data);
  msghdr message{};
  message.msg_name = &group_;
  message.msg_namelen = sizeof group_;
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  return sendmsg(fd_, &message, 0) >= 0;
}

}  // namespace curbstone::relay
