#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar_tool {

/// A UDP packet as it was captured or received.
struct Packet {
  std::int64_t received = 0;  ///< us since the Unix epoch
  lidar::sources::Ipv4 sender = 0;
  int port = 0;  ///< destination
  std::span<const std::uint8_t> bytes;
};

/// UDP packets that can be gone through more than once.
class Packets {
 public:
  using Handler = std::function<void(const Packet&)>;
  virtual ~Packets() = default;
  /// All of them in order. The bytes are valid inside the handler. A file that is cut off has what it has.
  virtual void for_each(const Handler& handler) const = 0;
  /// What was gone through did not end where it should.
  [[nodiscard]] virtual bool damaged() const { return false; }
  /// What was no whole UDP packet: "; 12 IP fragments". Known when all was gone through.
  [[nodiscard]] virtual std::string skipped() const { return ""; }
};

/// Where to listen, and how long.
struct ListenOptions {
  double seconds = 3;
  int info_port = 0;  ///< 0: the one that belongs to the port, as devices are delivered
};

/// "6699" is a port, anything else is a file.
[[nodiscard]] bool is_port(const std::string& where);

/// The packets of a capture, or those that come to a port (and to the port of the device information) within the time.
/// Throws std::runtime_error, one line.
[[nodiscard]] std::unique_ptr<Packets> packets_from(const std::string& where, const ListenOptions& options);

/// Hands over what comes to a port, and each 0.1 s the time, until the time is over.
void listen(int port, const ListenOptions& options, const Packets::Handler& on_packet,
            const std::function<void(std::int64_t now)>& on_time);

}  // namespace curbstone::lidar_tool
