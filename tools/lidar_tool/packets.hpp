#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar_tool {

/// A captured or received UDP packet.
struct Packet {
  std::int64_t received = 0;  ///< us since the Unix epoch
  lidar::sources::Ipv4 sender = 0;
  int port = 0;  ///< destination
  std::span<const std::uint8_t> bytes;
};

/// UDP packets that can be read repeatedly.
class Packets {
 public:
  using Handler = std::function<void(const Packet&)>;
  virtual ~Packets() = default;
  /// Passes all packets in order. The bytes are valid inside the handler. A truncated file gives its readable part.
  virtual void for_each(const Handler& handler) const = 0;
  /// Whether the packets ended prematurely.
  [[nodiscard]] virtual bool damaged() const { return false; }
  /// What was not a complete UDP packet: "; 12 IP fragments". Known after all packets were read.
  [[nodiscard]] virtual std::string skipped() const { return ""; }
};

/// Where and how long to listen.
struct ListenOptions {
  double seconds = 3;
  int info_port = 0;  ///< 0: the one belonging to the port by factory default
};

/// Whether `where` is a port ("6699"); anything else is a file.
[[nodiscard]] bool is_port(const std::string& where);

/// The packets of a capture, or those received on a port (and on the device information's port) within the time. Throws
/// std::runtime_error with a one-line message.
[[nodiscard]] std::unique_ptr<Packets> packets_from(const std::string& where, const ListenOptions& options);

/// Passes on what is received on a port, and the time every 0.1 s, until the time is over.
void listen(int port, const ListenOptions& options, const Packets::Handler& on_packet,
            const std::function<void(std::int64_t now)>& on_time);

}  // namespace curbstone::lidar_tool
