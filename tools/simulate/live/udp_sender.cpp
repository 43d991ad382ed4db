#include "tools/simulate/live/udp_sender.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace curbstone::simulate::live {

UdpSender::UdpSender(const std::string& host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1)
    throw std::runtime_error(fmt::format("--lidar-host {}: not an IPv4 address", host));
  fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ < 0 || connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error(fmt::format("cannot send to {}:{}: {}", host, port, std::strerror(error)));
  }
}

UdpSender::~UdpSender() {
  close(fd_);
}

void UdpSender::send(std::span<const std::uint8_t> bytes) const {
  // A refusal of an earlier datagram by the port is reported by this call, which then sends nothing: retry once.
  if (::send(fd_, bytes.data(), bytes.size(), 0) < 0 && errno == ECONNREFUSED)
    (void)!::send(fd_, bytes.data(), bytes.size(), 0);
}

}  // namespace curbstone::simulate::live
