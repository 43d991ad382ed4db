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
  std::string device_address;            ///< packets of other senders are dropped; empty = any sender
};

/// The sensor's interface does not exist or has no address yet, or another process has the port: it may pass.
class PortUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One UDP port that a sensor sends to. Non-blocking; watch fd() and call receive(). One thread.
class UdpSource {
 public:
  /// `received`: us since the Unix epoch, kernel time of receipt.
  using Handler = std::function<void(std::int64_t received, int port, std::span<const std::uint8_t>)>;

  /// Throws std::runtime_error with a one-line message that says how to fix the error: PortUnavailable if it may
  /// pass without help.
  UdpSource(int port, const UdpOptions& options);
  ~UdpSource();
  UdpSource(const UdpSource&) = delete;
  UdpSource& operator=(const UdpSource&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] int port() const { return port_; }
  /// Bytes of the receive buffer as granted by the kernel; may be less than requested.
  [[nodiscard]] int receive_buffer() const;

  /// Calls the handler for each packet that has arrived, at most kBatch. Packets are cut to 2 kB; no sensor sends
  /// longer ones. The bytes are valid inside the handler only.
  void receive(const Handler& handler);

  /// Packets dropped by the kernel since the start because this process was too slow.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

  /// Sender of the packet that the handler is called with.
  [[nodiscard]] Ipv4 sender() const { return sender_; }

  /// Dropped packets of senders other than `device_address`.
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
