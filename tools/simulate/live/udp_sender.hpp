#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace curbstone::simulate::live {

/// Sends datagrams to one address. A missing receiver is not an error.
class UdpSender {
 public:
  /// `host`: an IPv4 address. Throws std::runtime_error with a one-line message.
  UdpSender(const std::string& host, int port);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  void send(std::span<const std::uint8_t> bytes) const;

 private:
  int fd_ = -1;
};

}  // namespace curbstone::simulate::live
