#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace curbstone::simulate::live {

/// Sends datagrams to one address. That nobody listens is no error to a sender.
class UdpSender {
 public:
  /// `host` is an IPv4 address. Throws std::runtime_error with one clear line.
  UdpSender(const std::string& host, int port);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  void send(std::span<const std::uint8_t> bytes) const;

 private:
  int fd_ = -1;
};

}  // namespace curbstone::simulate::live
