#include "drivers/lidar/sources/udp_source.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "common/time/clock.hpp"

namespace curbstone::lidar::sources {

namespace {

in_addr address(const std::string& text, const char* key) {
  return {htonl(parse_ipv4(text, key))};
}

[[noreturn]] void fail_bind(int port, const std::string& host, int error) {
  switch (error) {
    case EADDRINUSE:
      throw PortUnavailable(fmt::format(
          "port {} is in use by another process: stop it (ss -ulpn 'sport = :{}' shows it) or choose another port",
          port, port));
    case EADDRNOTAVAIL:
      throw PortUnavailable(
          fmt::format("host_address: this machine has no interface with address {} (ip address shows them)", host));
    case EACCES:
      throw std::runtime_error(fmt::format("port {} may only be opened by root: choose one above 1023", port));
    default:
      throw std::runtime_error(fmt::format("port {}: {}", port, std::generic_category().message(error)));
  }
}

void join(int fd, const std::string& group, const std::string& host) {
  ip_mreq request{};
  request.imr_multiaddr = address(group, "group_address");
  request.imr_interface = address(host, "host_address");
  if (setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0) return;
  const int error = errno;
  const auto text =
      fmt::format("group_address: cannot join {} on {}: {}", group, host, std::generic_category().message(error));
  if (error == ENODEV || error == EADDRNOTAVAIL) throw PortUnavailable(text);
  throw std::runtime_error(text);
}

void enable(int fd, int option) {
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, option, &on, sizeof on);
}

}  // namespace

UdpSource::UdpSource(int port, const UdpOptions& options) : port_(port) {
  if (!options.device_address.empty()) device_ = parse_ipv4(options.device_address, "device_address");
  const bool multicast = !options.group_address.empty() && options.group_address != "0.0.0.0";
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_port = htons(static_cast<std::uint16_t>(port));
  local.sin_addr = address(options.host_address, "host_address");
  if (multicast) local.sin_addr.s_addr = htonl(INADDR_ANY);

  fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd_ < 0) throw std::runtime_error("UDP socket: " + std::generic_category().message(errno));
  try {
    // No SO_REUSEADDR: a second driver on the port would silently take the packets from the first. Root gets the
    // requested size; others what net.core.rmem_max allows.
    if (setsockopt(fd_, SOL_SOCKET, SO_RCVBUFFORCE, &options.receive_buffer, sizeof options.receive_buffer) != 0)
      setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &options.receive_buffer, sizeof options.receive_buffer);
    enable(fd_, SO_TIMESTAMPNS);
    enable(fd_, SO_RXQ_OVFL);
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&local), sizeof local) != 0)
      fail_bind(port, options.host_address, errno);
    if (multicast) join(fd_, options.group_address, options.host_address);
  } catch (...) {
    close(fd_);
    throw;
  }
}

UdpSource::~UdpSource() {
  close(fd_);
}

int UdpSource::receive_buffer() const {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  getsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &bytes, &size);
  return bytes / 2;  // the kernel doubles the requested size for its own overhead (socket(7))
}

void UdpSource::receive(const Handler& handler) {
  for (int i = 0; i < kBatch && receive_one(handler); ++i) {
  }
}

bool UdpSource::receive_one(const Handler& handler) {
  std::array<std::uint8_t, 65536> bytes;  // any datagram: one that is cut off could not be named
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> control;
  sockaddr_in sender{};
  iovec part{bytes.data(), bytes.size()};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(fd_, &message, 0);
  if (size < 0) return errno == EINTR || errno == ECONNREFUSED;

  std::int64_t received = 0;
  for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item)) {
    if (item->cmsg_level != SOL_SOCKET) continue;
    if (item->cmsg_type == SO_TIMESTAMPNS) {
      timespec time;
      std::memcpy(&time, CMSG_DATA(item), sizeof time);
      received = std::int64_t{time.tv_sec} * 1'000'000 + time.tv_nsec / 1000;
    } else if (item->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t overflow = 0;
      std::memcpy(&overflow, CMSG_DATA(item), sizeof overflow);
      dropped_ += overflow - last_overflow_;  // wraps like the kernel's counter
      last_overflow_ = overflow;
    }
  }
  sender_ = ntohl(sender.sin_addr.s_addr);
  if (device_ && sender_ != *device_) {
    ++foreign_;
    return true;
  }
  if (received == 0) received = wall_clock();
  handler(received, port_, std::span(bytes.data(), static_cast<std::size_t>(size)));
  return true;
}

}  // namespace curbstone::lidar::sources
