#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <span>
#include <string_view>

#include "common/bus/socket/bus_address.hpp"

namespace curbstone::relay {

/// Sends messages to the bus as single datagrams of LCM's wire format (LCM 1.3.1, `lcm_udpm.c`), from a port of its
/// own. By this port a relay distinguishes its own messages from those of other processes on the host. One thread.
class BusSender {
 public:
  /// Throws std::system_error with the kernel's reason.
  explicit BusSender(const BusAddress& address);
  ~BusSender();
  BusSender(const BusSender&) = delete;
  BusSender& operator=(const BusSender&) = delete;

  /// UDP source port of the messages.
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Returns false if the kernel does not accept the datagram.
  bool send(std::string_view channel, std::span<const std::uint8_t> data);

 private:
  int fd_ = -1;
  sockaddr_in group_{};
  std::uint16_t port_ = 0;
  std::uint32_t number_ = 0;
};

}  // namespace curbstone::relay
