#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar::sources {

struct UdpOptions {
  std::string host_address = "0.0.0.0";  ///< interface to listen on
  std::string group_address;             ///< multicast group to join; empty = none
  int receive_buffer = 4 << 20;          ///< bytes; the kernel may grant less
  std::string device_address;            ///< packets of other senders are not handed over; empty = of any
};

/// The interface that the sensor is on is not there, or has no address yet: it may come.
class InterfaceMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One UDP port that a sensor sends to. Non-blocking; watch fd() and call receive(). One thread.
class UdpSource {
 public:
  /// `received`: us since the Unix epoch, by the kernel, when the packet reached the host.
  using Handler = std::function<void(std::int64_t received, int port, std::span<const std::uint8_t>)>;

  /// Throws std::runtime_error with one line that says what is wrong and how to mend it: InterfaceMissing where it may
  /// mend itself.
  UdpSource(int port, const UdpOptions& options);
  ~UdpSource();
  UdpSource(const UdpSource&) = delete;
  UdpSource& operator=(const UdpSource&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] int port() const { return port_; }
  /// bytes of the receive buffer as the kernel granted it; it may be less than was asked for.
  [[nodiscard]] int receive_buffer() const;

  /// Calls the handler for each packet that has arrived, at most kBatch. Packets are cut to 2 kB; no sensor sends
  /// longer ones. The bytes are valid inside the handler only.
  void receive(const Handler& handler);

  /// Packets that the kernel has dropped since the start, because this process was too slow.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

  /// Who sent the packet that the handler is called with.
  [[nodiscard]] Ipv4 sender() const { return sender_; }

  /// Packets of senders other than `device_address`, which were not handed over.
  [[nodiscard]] std::int64_t foreign() const { return foreign_; }

  static constexpr int kBatch = 64;

 private:
  bool receive_one(const Handler& handler);

  int fd_ = -1;
  int port_;
  std::optional<Ipv4> device_;
  Ipv4 sender_ = 0;
  std::int64_t foreign_ = 0;
  std::int64_t dropped_ = 0;
  std::uint32_t last_overflow_ = 0;
};

}  // namespace curbstone::lidar::sources
